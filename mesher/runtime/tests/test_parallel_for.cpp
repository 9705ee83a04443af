#include "runtime/parallel_for.h"

#include <gtest/gtest.h>

#include <new>
#include <numeric>
#include <thread>

namespace podm::test {
namespace {

TEST(ParallelFor, RunsEveryRoundOnceOnItsThreads) {
  for (const std::size_t count : {0u, 1u, 3u, 1000u}) {
    for (const std::size_t threads : {1u, 2u, 5u}) {
      std::vector<int> rounds(count);
      std::vector<std::size_t> rounds_of(threads);
      parallel_for(count, threads, [&](std::size_t i, std::size_t thread) {
        ++rounds[i];
        ++rounds_of.at(thread);
      });
      EXPECT_EQ(rounds, std::vector<int>(count, 1));
      EXPECT_EQ(std::accumulate(rounds_of.begin(), rounds_of.end(), std::size_t{0}), count);
    }
  }
}

void expect_first_fault() {
  EXPECT_THROW(parallel_for(1000, 4,
                            [](std::size_t i, std::size_t) {
                              if (i % 7 == 3) throw std::bad_alloc();
                            }),
               std::bad_alloc);
}

TEST(ParallelFor, ThrowsWhatAnyThreadThrew) {
  expect_first_fault();
  VirtualThreads threads;
  const VirtualThreads::Scope scope(threads);
  expect_first_fault();
}

void work_for(double seconds) {
  const double start_s = processor_seconds();
  while (processor_seconds() - start_s < seconds) {
  }
}

TEST(ParallelFor, VirtualThreadsRunEveryRoundOnceOnTheCallingThread) {
  VirtualThreads threads;
  const VirtualThreads::Scope scope(threads);
  for (const std::size_t count : {0u, 1u, 3u, 1000u}) {
    std::vector<int> rounds(count);
    const std::thread::id caller = std::this_thread::get_id();
    parallel_for(count, 5, [&](std::size_t i, std::size_t thread) {
      ++rounds[i];
      EXPECT_LT(thread, 5u);
      EXPECT_EQ(std::this_thread::get_id(), caller);
    });
    EXPECT_EQ(rounds, std::vector<int>(count, 1));
  }
}

// Seven rounds of 10 ms and one of 40 ms: four threads need 40 ms at least.
TEST(ParallelFor, VirtualThreadsSaveWhatRealThreadsWould) {
  const double round_s = 0.01;
  VirtualThreads threads;
  const VirtualThreads::Scope scope(threads);
  const double start_s = processor_seconds();
  parallel_for(8, 4, [&](std::size_t i, std::size_t) { work_for(i == 0 ? 4 * round_s : round_s); });
  const double spent_s = processor_seconds() - start_s, saved_s = threads.take_saved_s();
  EXPECT_LE(spent_s - saved_s, spent_s - 4 * round_s);
  EXPECT_GE(spent_s - saved_s, 4 * round_s);
  EXPECT_EQ(threads.take_saved_s(), 0);

  parallel_for(3, 1, [&](std::size_t, std::size_t) { work_for(round_s); });
  EXPECT_NEAR(threads.take_saved_s(), 0, 1e-9) << "one thread saves nothing";
}

TEST(ParallelFor, ALoopInsideALoopOfVirtualThreadsSavesNothingByItself) {
  const double round_s = 0.01;
  VirtualThreads threads;
  const VirtualThreads::Scope scope(threads);
  const auto inner = [&](std::size_t, std::size_t) {
    parallel_for(2, 2, [&](std::size_t, std::size_t) { work_for(round_s); });
  };
  parallel_for(2, 2, inner);
  const double saved_s = threads.take_saved_s();
  EXPECT_GT(saved_s, round_s);
  EXPECT_LT(saved_s, 3 * round_s) << "each of two threads runs its inner loop alone";
}

TEST(ParallelFor, NoNumberMeansAllCores) {
  EXPECT_EQ(num_threads(3), 3u);
  EXPECT_GE(num_threads(0), 1u);
}

}  // namespace
}  // namespace podm::test
