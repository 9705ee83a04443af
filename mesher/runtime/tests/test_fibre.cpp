#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "runtime/fibre.h"

namespace podm::test {
namespace {

using State = Fibre::State;

void step() { Fibre::current()->step(); }

TEST(Fibre, GoesOnWhereItSuspended) {
  int passed = 0;
  Fibre fibre([&] {
    for (; passed < 3; ++passed) Fibre::current()->suspend();
  });
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(fibre.resume(), State::kSuspended);
    EXPECT_EQ(passed, i);
  }
  EXPECT_EQ(Fibre::current(), nullptr);
  EXPECT_EQ(fibre.resume(), State::kEnded);
  EXPECT_EQ(passed, 3);
}

TEST(Fibre, StopsWhenItIsOutOfSteps) {
  int passed = 0;
  Fibre fibre([&] {
    for (; passed < 5; ++passed) step();
  });
  fibre.allow(1);
  EXPECT_EQ(fibre.resume(), State::kOutOfSteps);
  EXPECT_EQ(passed, 0);
  fibre.allow(3);
  EXPECT_EQ(fibre.resume(), State::kOutOfSteps);
  EXPECT_EQ(passed, 3);
  EXPECT_TRUE(fibre.is_limited() || passed == 3);
  fibre.allow(Fibre::kUnlimited);
  EXPECT_FALSE(fibre.is_limited());
  EXPECT_EQ(fibre.resume(), State::kEnded);
  EXPECT_EQ(passed, 5);
}

TEST(Fibre, KeepsItsCallApartFromOthers) {
  std::string order;
  const auto call = [&order](char name) {
    return [&order, name] {
      Fibre* const self = Fibre::current();
      for (int i = 0; i < 3; ++i) {
        order += name;
        self->suspend();
        EXPECT_EQ(Fibre::current(), self);
      }
    };
  };
  Fibre first(call('a')), second(call('b'));
  while (first.resume() != State::kEnded) second.resume();
  while (second.state() != State::kEnded) second.resume();
  EXPECT_EQ(order, "ababab");
}

TEST(Fibre, ThrowsWhereItIsResumed) {
  Fibre fibre([] {
    Fibre::current()->suspend();
    throw std::runtime_error("thrown");
  });
  EXPECT_EQ(fibre.resume(), State::kSuspended);
  EXPECT_THROW(fibre.resume(), std::runtime_error);
  EXPECT_EQ(fibre.state(), State::kEnded);
}

TEST(Fibre, StopsAtNoStepWhileItHandlesAnException) {
  bool has_handled = false;
  Fibre fibre([&] {
    try {
      throw std::runtime_error("thrown");
    } catch (const std::runtime_error&) {
      step();
      has_handled = true;
    }
    step();
  });
  fibre.allow(1);
  EXPECT_EQ(fibre.resume(), State::kOutOfSteps);
  EXPECT_TRUE(has_handled);
  fibre.allow(Fibre::kUnlimited);
  EXPECT_EQ(fibre.resume(), State::kEnded);
}

}  // namespace
}  // namespace podm::test
