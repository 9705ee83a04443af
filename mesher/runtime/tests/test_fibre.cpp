#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "runtime/fibre.h"

namespace podm::test {
namespace {

void step() { Fibre::current()->step(); }

TEST(Fibre, StopsAtSteps) {
  Fibre fibre;
  EXPECT_TRUE(fibre.has_ended());
  int passed = 0;
  fibre.begin([&] {
    for (; passed < 5; ++passed) step();
  });
  EXPECT_FALSE(fibre.resume(1));
  EXPECT_EQ(passed, 0);
  EXPECT_FALSE(fibre.resume(3));
  EXPECT_EQ(passed, 3);
  EXPECT_FALSE(fibre.has_ended());
  EXPECT_TRUE(fibre.resume(3));
  EXPECT_EQ(passed, 5);
  EXPECT_EQ(Fibre::current(), nullptr);
}

TEST(Fibre, KeepsItsCallApartFromOthers) {
  Fibre first, second;
  std::string order;
  const auto call = [&order](char name) {
    return [&order, name] {
      const Fibre* self = Fibre::current();
      for (int i = 0; i < 3; ++i) {
        order += name;
        step();
        EXPECT_EQ(Fibre::current(), self);
      }
    };
  };
  first.begin(call('a'));
  second.begin(call('b'));
  while (!first.resume(1)) second.resume(1);
  EXPECT_EQ(order, "ababab");
}

TEST(Fibre, ThrowsWhereItIsResumedAndMayBeginAgain) {
  Fibre fibre;
  fibre.begin([] {
    step();
    throw std::runtime_error("thrown");
  });
  EXPECT_FALSE(fibre.resume(1));
  EXPECT_THROW(fibre.resume(1), std::runtime_error);
  EXPECT_TRUE(fibre.has_ended());
  fibre.begin([] {});
  EXPECT_TRUE(fibre.resume(1));
}

TEST(Fibre, DoesNotStopWhileItHandlesAnException) {
  Fibre fibre;
  fibre.begin([] {
    try {
      throw std::runtime_error("thrown");
    } catch (const std::runtime_error&) {
      step();
      throw;
    }
  });
  EXPECT_THROW(fibre.resume(1), std::runtime_error);
}

}  // namespace
}  // namespace podm::test
