// Real and virtual time: how workers run, block and are resumed, and how runs end.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <new>
#include <random>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "podm/errors.h"
#include "workers/real_time.h"
#include "workers/virtual_time.h"

namespace podm::test {
namespace {

constexpr std::size_t kThree = 3;

struct OnThreads {
  static RealTime make(StopControl& stop) { return {stop, kThree, {}}; }
};
struct InVirtualTime {
  static VirtualTime make(StopControl& stop) { return {stop, kThree, VirtualCost::kUnit, 1}; }
};

template <class Kind>
class Times : public testing::Test {
 protected:
  StopControl stop_{{}, {}, [](std::uint64_t) {}};
};
using Kinds = testing::Types<OnThreads, InVirtualTime>;
TYPED_TEST_SUITE(Times, Kinds);

TYPED_TEST(Times, LetEveryWorkerWorkOnce) {
  auto time = TypeParam::make(this->stop_);
  std::array<std::atomic<int>, kThree> calls{};
  time.run([&](WorkerId self) { ++calls[self]; });
  for (const auto& of_worker : calls) EXPECT_EQ(of_worker, 1);
}

// Each worker of the second run sees what all workers did in the first, and time goes on.
TYPED_TEST(Times, RunAgain) {
  auto time = TypeParam::make(this->stop_);
  std::array<std::atomic<int>, kThree> calls{};
  time.run([&](WorkerId self) {
    ++calls[self];
    time.pause(self, 0.001);
  });
  const double between_s = time.now_s();
  time.run([&](WorkerId self) {
    EXPECT_GE(time.now_s(), between_s);
    for (const auto& of_worker : calls) EXPECT_GE(of_worker, 1);
    time.pause(self, 0.001);
    ++calls[self];
  });
  EXPECT_GT(time.now_s(), between_s);
  for (const auto& of_worker : calls) EXPECT_EQ(of_worker, 2);
}

// Worker 0 is resumed before or while it blocks. Each other worker that blocks is resumed by the next one.
TYPED_TEST(Times, ResumeWhoBlocks) {
  auto time = TypeParam::make(this->stop_);
  std::atomic<int> num_resumed = 0;
  time.run([&](WorkerId self) {
    if (self + 1 < kThree) time.block(self, &Overhead::begging_s);
    ++num_resumed;
    if (self > 0) time.resume(self - 1);
  });
  EXPECT_EQ(num_resumed, static_cast<int>(kThree));
}

TYPED_TEST(Times, EndTheBlockingWhenTheRunIsOver) {
  auto time = TypeParam::make(this->stop_);
  std::atomic<int> num_over = 0;
  time.run([&](WorkerId self) {
    if (self == 0) {
      this->stop_.end(StopReason::kTimeLimit);
    } else {
      time.block(self, &Overhead::contention_s);
    }
    num_over += time.is_over();
  });
  EXPECT_EQ(num_over, static_cast<int>(kThree));
  EXPECT_EQ(this->stop_.reason(), StopReason::kTimeLimit);
}

// All workers block until worker 0 observes that the run is over.
TEST(RealTime, ObservesWhileWorker0Blocks) {
  const auto caller = std::this_thread::get_id();
  std::stop_source source;
  StopControl stop{{}, source.get_token(), [&](std::uint64_t) {
                     EXPECT_EQ(std::this_thread::get_id(), caller);
                     source.request_stop();
                   }};
  RealTime time = OnThreads::make(stop);
  time.run([&](WorkerId self) { time.block(self, &Overhead::begging_s); });
  EXPECT_EQ(stop.reason(), StopReason::kCancelled);
}

TYPED_TEST(Times, ThrowAgainWhatAWorkerThrows) {
  auto time = TypeParam::make(this->stop_);
  EXPECT_THROW(time.run([&](WorkerId self) {
    if (self == 1) throw std::runtime_error("thrown");
    time.block(self, &Overhead::begging_s);
  }),
               std::runtime_error);
  EXPECT_TRUE(this->stop_.is_over());
}

TYPED_TEST(Times, ThrowAgainOneOfWhatSeveralThrow) {
  auto time = TypeParam::make(this->stop_);
  EXPECT_THROW(time.run([&](WorkerId self) {
    if (self == 0) throw std::bad_alloc();
    time.block(self, &Overhead::begging_s);
    throw std::runtime_error("thrown by two");
  }),
               std::runtime_error);
}

TYPED_TEST(Times, TakeALackOfMemoryForALimit) {
  auto time = TypeParam::make(this->stop_);
  time.run([&](WorkerId self) {
    if (self == 1) throw std::bad_alloc();
    time.block(self, &Overhead::begging_s);
  });
  EXPECT_EQ(this->stop_.reason(), StopReason::kMemoryLimit);
}

TYPED_TEST(Times, ChargePausesAndBlocks) {
  auto time = TypeParam::make(this->stop_);
  constexpr double kPause = 0.002;
  const double start_s = time.now_s();
  time.run([&](WorkerId self) {
    if (self == 0) time.pause(self, kPause);
  });
  EXPECT_GE(time.now_s() - start_s, kPause);
}

TEST(VirtualTime, ThatStandsStillIsAnError) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  VirtualTime time(stop, kThree, VirtualCost::kUnit, 1);
  EXPECT_THROW(time.run([&](WorkerId self) { time.block(self, &Overhead::begging_s); }), InternalError);
}

MachineModel slow_machine(double core_speed, double wake_s) {
  MachineModel machine{.name = "slow", .topology = Topology::synthetic("core:4 pu:1")};
  machine.core_speed = core_speed;
  machine.wake_s = wake_s;
  return machine;
}

TEST(VirtualTime, OfSlowCoresTakesLonger) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  const MachineModel machine = slow_machine(0.25, 0);
  VirtualTime time(stop, kThree, VirtualCost::kMeasured, 1, &machine);
  time.run([&](WorkerId self) { time.spend(self, 1.0); });
  EXPECT_DOUBLE_EQ(time.now_s(), 4);
  EXPECT_DOUBLE_EQ(time.spending().between_s, 4 * kThree);
}

TEST(VirtualTime, WakesALittleLater) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  const MachineModel machine = slow_machine(1, 0.125);
  VirtualTime time(stop, kThree, VirtualCost::kMeasured, 1, &machine);
  time.run([&](WorkerId self) {
    if (self == 0) time.block(self, &Overhead::begging_s);
    if (self == 1) time.resume(0);
  });
  EXPECT_DOUBLE_EQ(time.now_s(), 0.125);
}

TEST(VirtualTime, LetsOneWorkerAtATimeIntoASection) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  VirtualTime time(stop, kThree, VirtualCost::kMeasured, 1);
  const int one = 0, another = 0;
  std::array<double, kThree> left_at{};
  time.run([&](WorkerId self) {
    time.spend_in(self == 2 ? &another : &one, self, 1.0);
    left_at[self] = time.now_s();
  });
  EXPECT_DOUBLE_EQ(left_at[0], 1);
  EXPECT_DOUBLE_EQ(left_at[1], 2);
  EXPECT_DOUBLE_EQ(left_at[2], 1);
  EXPECT_DOUBLE_EQ(time.spending().queueing_s, 1);
}

MachineModel machine_of_sharing(double line_transfer_s, double page_fault_s) {
  MachineModel machine{.name = "shared", .topology = Topology::synthetic("core:4 pu:1")};
  machine.line_transfer_s = line_transfer_s;
  machine.page_fault_s = page_fault_s;
  return machine;
}

// The line of the section's mutex is at the second worker's core until the third one enters.
TEST(VirtualTime, ChargesALineThatAnotherWorkerHadLast) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  const MachineModel machine = machine_of_sharing(0.25, 0);
  VirtualTime time(stop, kThree, VirtualCost::kMeasured, 1, &machine);
  const int section = 0;
  std::array<double, kThree> left_at{};
  time.run([&](WorkerId self) {
    for (int i = 0; i < (self == 1 ? 2 : 1); ++i) time.spend_in(&section, self, 1.0);
    left_at[self] = time.now_s();
  });
  EXPECT_DOUBLE_EQ(left_at[0], 1.25);
  EXPECT_DOUBLE_EQ(left_at[2], 3.75);
  EXPECT_DOUBLE_EQ(left_at[1], 5) << "after the third worker";
}

// A worker whose attempts add cells. It may also take two locks of an arena and four pages in each.
struct Asking {
  WorkerId id() const { return self; }
  Outcome attempt() {
    ++num_attempts;
    return outcome;
  }
  void release() {}
  std::int64_t net_cells() const { return static_cast<std::int64_t>(100 * num_attempts); }
  const Counters& counters() const { return counts; }
  const std::optional<AccessTally>& accesses() const { return tally; }
  SharedRequests shared_requests() const {
    return asks ? SharedRequests{2 * num_attempts, 4 * kPageBytes * num_attempts} : SharedRequests{};
  }

  WorkerId self = 0;
  bool asks = true;
  std::uint64_t num_attempts = 0;
  Counters counts = {};
  std::optional<AccessTally> tally = {};
  Outcome outcome = Outcome::kCommitted;
};

// Returns the virtual seconds of as many attempts by each of three workers.
double seconds_of_asking(const MachineModel* machine, int num_attempts, bool asks = true) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  VirtualTime time(stop, kThree, VirtualCost::kMeasured, 1, machine);
  std::array<Asking, kThree> workers{Asking{0, asks}, Asking{1, asks}, Asking{2, asks}};
  time.run([&](WorkerId self) {
    for (int i = 0; i < num_attempts; ++i) time.attempt(workers[self]);
  });
  return time.now_s();
}

TEST(VirtualTime, OfAMachineWithoutCostsOfSharingIsTheSameToTheBit) {
  const MachineModel none = machine_of_sharing(0, 0);
  EXPECT_EQ(seconds_of_asking(&none, 1000), seconds_of_asking(nullptr, 1000));
}

TEST(VirtualTime, CountsSecondsOfSharingOnce) {
  const MachineModel machine = machine_of_sharing(0.25, 0.5);
  for (const Outcome outcome : {Outcome::kCommitted, Outcome::kLockConflict}) {
    StopControl stop({}, {}, [](std::uint64_t) {});
    VirtualTime time(stop, 1, VirtualCost::kMeasured, 1, &machine);
    Asking worker;
    worker.outcome = outcome;
    time.run([&](WorkerId) {
      for (int i = 0; i < 10; ++i) time.attempt(worker);
    });
    EXPECT_GT(time.now_s(), 10 * 4 * 0.5);
    EXPECT_NEAR(time.busy_s(), time.now_s(), 1e-9);
  }
}

// Attempts themselves take less than a microsecond.
TEST(VirtualTime, ServesOneWorkerAtATimeWithNewPages) {
  const MachineModel machine = machine_of_sharing(0, 0.5);
  EXPECT_NEAR(seconds_of_asking(&machine, 10), 3 * 10 * 4 * 0.5, 1);
}

// The first of the two locks of an attempt takes a transfer.
TEST(VirtualTime, PassesTheLineOfALockFromWorkerToWorker) {
  const MachineModel machine = machine_of_sharing(0.25, 0);
  EXPECT_NEAR(seconds_of_asking(&machine, 10), 3 * 10 * 0.25, 1);
}

TEST(VirtualTime, PassesTheLineOfTheNumberOfCellsAsOftenAsItIsReported) {
  const MachineModel machine = machine_of_sharing(0.25, 0);
  const int attempts = StopControl::kAttemptsBetweenChecks;
  ASSERT_GT(100 * attempts, StopControl::kLongestReportingStep);
  EXPECT_NEAR(seconds_of_asking(&machine, attempts - 1, false), 0, 0.01);
  EXPECT_NEAR(seconds_of_asking(&machine, attempts, false), 3 * 0.25, 0.01);
}

// A worker whose attempts fail. Records if it holds its locks.
struct Failing {
  WorkerId id() const { return 0; }
  Outcome attempt() {
    holds = true;
    ++counts.classified_cells;
    return Outcome::kLockConflict;
  }
  void release() { holds = false; }
  std::int64_t net_cells() const { return 0; }
  const Counters& counters() const { return counts; }
  const std::optional<AccessTally>& accesses() const { return tally; }

  bool holds = false;
  Counters counts;
  std::optional<AccessTally> tally;
};

TEST(VirtualTime, AFailingAttemptHoldsItsLocksButForAWhile) {
  StopControl stop({}, {}, [](std::uint64_t) {});
  VirtualTime time(stop, 2, VirtualCost::kMeasured, 1);
  Failing worker;
  bool was_held = false, was_free_after = false, has_ended = false;
  time.run([&](WorkerId self) {
    if (self == 0) {
      time.attempt(worker);
      has_ended = true;
    }
    while (self == 1 && !has_ended) {
      was_free_after = was_free_after || (was_held && !worker.holds);
      was_held = was_held || worker.holds;
      time.spend(self, 1e-9);
    }
  });
  EXPECT_TRUE(was_held);
  EXPECT_TRUE(was_free_after) << "others have their turn";
  EXPECT_FALSE(worker.holds);
  EXPECT_GT(time.overhead(worker).rollback_s, 0);
  EXPECT_EQ(time.spending().work_s, 0) << "what is rolled back is no work";
}

// The construction of leaves checks over() and not reason().
// A worker that only adds cells; a mesh would take a long time to get as many.
struct Adding {
  std::int64_t cells = 0;
  std::int64_t net_cells() const { return cells; }
};

// Unreported cells are at most a fourth of what the limit leaves, and what a worker adds between two checks.
TEST(StopControl, EndsAtTheLimitOfElementsHoweverSeldomWorkersReport) {
  constexpr std::int64_t kMoreAtOnce = 700;
  for (const std::int64_t limit : {1, 1000, 100'000, 30'000'000})
    for (const std::size_t num_workers : {1, 3, 256}) {
      StopControl stop({.max_elements = static_cast<std::uint64_t>(limit)}, {}, [](std::uint64_t) {});
      std::vector<Adding> workers(num_workers);
      std::vector<CellMeter> meters(num_workers);
      std::mt19937 random(5);
      std::int64_t cells = 0;
      while (!stop.is_over()) {
        const std::size_t i = random() % num_workers;
        workers[i].cells += kMoreAtOnce;
        cells += kMoreAtOnce;
        meters[i].report_if_due(workers[i], num_workers, stop);
        stop.check_limits();
        ASSERT_LE(cells, limit + kMoreAtOnce * static_cast<std::int64_t>(num_workers + 1));
      }
      EXPECT_GT(cells, limit);
      EXPECT_EQ(stop.reason(), StopReason::kElementLimit);
    }
}

TEST(StopControl, HearsOfFewReportsWithoutALimit) {
  constexpr std::int64_t kChecks = 100'000;
  StopControl stop({}, {}, [](std::uint64_t) {});
  Adding worker{};
  CellMeter meter;
  std::int64_t num_reports = 0, reported = 0;
  for (int check = 0; check < kChecks; ++check) {
    worker.cells += 500;
    meter.report_if_due(worker, 256, stop);
    num_reports += stop.num_cells() != std::exchange(reported, stop.num_cells());
  }
  EXPECT_LE(num_reports, kChecks / 32);
  meter.report(worker, stop);
  EXPECT_EQ(stop.num_cells(), worker.cells);
}

TEST(StopControl, IsOverAsSoonAsAStopIsRequested) {
  std::stop_source source;
  StopControl stop({}, source.get_token(), [](std::uint64_t) {});
  EXPECT_FALSE(stop.over().stop_requested());
  EXPECT_EQ(stop.reason(), StopReason::kComplete);
  source.request_stop();
  EXPECT_TRUE(stop.over().stop_requested());
  EXPECT_TRUE(stop.is_over());
  EXPECT_EQ(stop.reason(), StopReason::kCancelled);
}

}  // namespace
}  // namespace podm::test
