// Memory that runs out, and limits that are reached, at any moment of a run with any executor: all workers
// stop between operations, and the mesh is a valid triangulation.
#include <gtest/gtest.h>
#include <unistd.h>

#include <new>
#include <string>

#include "algorithms/podm.h"
#include "delaunay/tests/validity.h"
#include "failing_allocator.h"
#include "failing_threads.h"
#include "image/foreground.h"
#include "podm/errors.h"
#include "podm/operation_log.h"
#include "refine/virtual_box.h"
#include "tests/images.h"

namespace podm::test {
namespace {

struct Setup {
  Algorithm algorithm;
  Executor executor;
  int num_workers;
  int numa_nodes = 1;
  bool has_perturbation = false;
};
const std::vector<Setup> kSetups{
    {Algorithm::kPodm, Executor::kThreads, 1},          {Algorithm::kPodm, Executor::kThreads, 4},
    {Algorithm::kPodm, Executor::kVirtual, 6},          {Algorithm::kPdr, Executor::kThreads, 2},
    {Algorithm::kPdr, Executor::kVirtual, 4},           {Algorithm::kPdrPodm, Executor::kThreads, 4},
    {Algorithm::kPdrPodm, Executor::kVirtual, 6},       {Algorithm::kPdrPodm, Executor::kThreads, 4, 2},
    {Algorithm::kPdrPodm, Executor::kVirtual, 6, 2},    {Algorithm::kPodmHome, Executor::kThreads, 4, 2},
    {Algorithm::kPodmHome, Executor::kVirtual, 6, 2},   {Algorithm::kPodm, Executor::kThreads, 1, 1, true},
    {Algorithm::kPodm, Executor::kThreads, 4, 1, true}, {Algorithm::kPdr, Executor::kVirtual, 4, 1, true},
};

Topology machine_of_nodes(int num_nodes) {
  return Topology::synthetic("numa:" + std::to_string(num_nodes) + " core:3 pu:1");
}

// Workers node after node, not bound.
std::vector<Place> places_in(const Topology& machine, int num_workers) {
  std::vector<Place> places = place_workers(machine, {}, num_workers, true);
  for (Place& place : places) place.processor.reset();
  return places;
}

void expect_valid(const Mesh& mesh) {
  std::string fault;
  EXPECT_TRUE(is_valid(mesh, &fault)) << fault;
}

class Faults : public testing::TestWithParam<Setup> {
 protected:
  Refinement refine(StopControl& stop, std::size_t cell_capacity = 1 << 20,
                    std::size_t most_numbered = 1 << 30, std::uint64_t memory_bytes = 1 << 30) {
    const Algorithm algorithm = GetParam().algorithm;
    const int num_workers = GetParam().num_workers;
    const Problem problem{.isosurface = isosurface_,
                          .object = foreground_bounds(image_),
                          .delta_mm = 1.2,
                          .sizes = sizes_,
                          .cell_capacity = cell_capacity,
                          .memory_bytes = memory_bytes,
                          .most_numbered_cells = most_numbered,
                          .dihedral_bounds = dihedral_bounds()};
    const Team team{.executor = GetParam().executor,
                    .coordination = {.num_workers = num_workers, .seed = 3},
                    .num_nodes = algorithm == Algorithm::kPdr ? num_workers : 2,
                    .initial_workers = num_workers,
                    .machine = &machine_,
                    .places = places_};
    if (algorithm == Algorithm::kPodm) return podm(problem, team, stop);
    if (algorithm == Algorithm::kPodmHome) return podm_home(problem, team, stop);
    const LeafOptions leaves{.initial_ratio = 2, .size_mm = 4};
    return algorithm == Algorithm::kPdr ? pdr(problem, team, leaves, stop)
                                        : pdr_podm(problem, team, leaves, stop);
  }
  static std::optional<DihedralBounds> dihedral_bounds() {
    return GetParam().has_perturbation ? std::optional(DihedralBounds(15, 155)) : std::nullopt;
  }
  static StopControl patient() {
    return {{}, {}, [](std::uint64_t) {}};
  }

  LabelImage image_ = ball(16, 6);
  Isosurface isosurface_{image_, 1};
  SizeField sizes_{std::vector<double>(2, 1.6)};
  Topology machine_ = machine_of_nodes(GetParam().numa_nodes);
  std::vector<Place> places_ = places_in(machine_, GetParam().num_workers);
};

// Fails each of the first allocations, which are all of a run of podm on one thread. A run leaf by leaf has
// thousands; some fail, at growing distances.
TEST_P(Faults, AllocationsThatFailLeaveAValidMesh) {
  constexpr std::int64_t kOneByOne = 150;
  int num_ended = 0, num_complete = 0;
  for (std::int64_t left = 0; num_complete < 3; left += left < kOneByOne ? 1 : 1 + left / 8) {
    StopControl stop = patient();
    allocations_left = left;
    try {
      const Refinement refinement = refine(stop);
      const bool has_failed = allocations_left.exchange(-1) < 0;
      EXPECT_EQ(refinement.stop_reason, has_failed ? StopReason::kMemoryLimit : StopReason::kComplete)
          << left;
      num_ended += has_failed;
      num_complete += !has_failed;
      expect_valid(*refinement.mesh);
    } catch (const std::bad_alloc&) {  // before the run began
      allocations_left = -1;
    }
  }
  EXPECT_GT(num_ended, 3);
}

TEST_P(Faults, StoresThatFillUpLeaveAValidMesh) {
  int num_ended = 0;
  for (std::size_t capacity = 1100; capacity < 60000; capacity += 1 + capacity / 5) {
    StopControl stop = patient();
    const Refinement refinement = refine(stop, capacity);
    num_ended += refinement.stop_reason == StopReason::kMemoryLimit;
    expect_valid(*refinement.mesh);
  }
  EXPECT_GT(num_ended, 5);
}

TEST_P(Faults, StoresWithoutNumbersAreDistinguishedFromThoseWithoutMemory) {
  constexpr std::size_t kCapacity = 1500;
  StopControl of_numbers = patient(), of_memory = patient();
  EXPECT_EQ(refine(of_numbers, kCapacity, kCapacity).stop_reason, StopReason::kNumberLimit);
  EXPECT_EQ(refine(of_memory, kCapacity, kCapacity + 1).stop_reason, StopReason::kMemoryLimit);
}

TEST_P(Faults, LeavesThatWouldTakeMostOfTheMemoryAreRefused) {
  StopControl stop = patient();
  const auto refine_in = [&](std::uint64_t bytes) {
    return refine(stop, 1 << 20, 1 << 30, bytes).stop_reason;
  };
  const Algorithm algorithm = GetParam().algorithm;
  if (algorithm == Algorithm::kPodm || algorithm == Algorithm::kPodmHome) {
    EXPECT_EQ(refine_in(1 << 16), StopReason::kComplete) << "it has none";
  } else {
    EXPECT_THROW(refine_in(1 << 16), InputError);
  }
  EXPECT_EQ(refine_in(1 << 24), StopReason::kComplete);
}

TEST_P(Faults, StopRequestsAndLimitsLeaveAValidMesh) {
  StopControl whole = patient();
  const std::uint64_t all_cells = refine(whole).mesh->num_cells();
  for (std::uint64_t cells = 1; cells < all_cells; cells += 1 + cells / 2) {
    StopControl limited({.max_elements = cells}, {}, [](std::uint64_t) {});
    const Refinement refinement = refine(limited);
    EXPECT_EQ(refinement.stop_reason, StopReason::kElementLimit) << cells << " of " << all_cells;
    expect_valid(*refinement.mesh);
  }
  std::stop_source source;
  source.request_stop();
  StopControl stopped({}, source.get_token(), [](std::uint64_t) {});
  const Refinement refinement = refine(stopped);
  EXPECT_EQ(refinement.stop_reason, StopReason::kCancelled);
  expect_valid(*refinement.mesh);
  StopControl late({.max_seconds = 1e-9}, {}, [](std::uint64_t) {});
  EXPECT_EQ(refine(late).stop_reason, StopReason::kTimeLimit);
}

class RelocationFaults : public testing::TestWithParam<Executor> {};

// Fails each allocation of the move alone: for its lists, and for the threads or fibres of its steps.
TEST_P(RelocationFaults, AllocationsThatFailLeaveAValidMeshOrNone) {
  constexpr int kWorkers = 4;
  const LabelImage image = ball(16, 6);
  const Isosurface isosurface(image, 1);
  const Topology machine = machine_of_nodes(2);
  const Problem problem{.isosurface = isosurface,
                        .object = foreground_bounds(image),
                        .delta_mm = 2,
                        .sizes = SizeField({3, 3}),
                        .cell_capacity = 1 << 16};
  const Team team{.executor = GetParam(),
                  .coordination = {.num_workers = kWorkers},
                  .num_nodes = 2,
                  .machine = &machine,
                  .places = places_in(machine, kWorkers)};
  const Box clamp = grown(problem.object, 4);
  const Parameters parameters = parameters_for(problem, 1, clamp);
  // The lower half goes to the second node. Cells that the first worker made above it stay.
  const auto worker_of = [&](const Point& p) { return p.z < 7.5 ? WorkerId{kWorkers - 1} : kNoWorker; };
  int num_unmoved = 0, num_moved = 0;
  bool has_failed = true;
  for (std::int64_t left = 0; has_failed; ++left) {
    StopControl stop({}, {}, [](std::uint64_t) {});
    Construction construction(problem, clamp, team, stop);
    refine_anywhere(construction, "initial", parameters, construction.all_cells(), 1);
    bool is_moved = false;
    try {
      construction.in_time("refine", kWorkers, [&](auto& time) {
        allocations_left = left;
        is_moved = construction.relocate(time, worker_of).has_value();
        has_failed = allocations_left.exchange(-1) < 0;
      });
    } catch (const std::bad_alloc&) {
      allocations_left = -1;
      continue;
    }
    EXPECT_EQ(stop.reason(), has_failed ? StopReason::kMemoryLimit : StopReason::kComplete) << left;
    EXPECT_TRUE(is_moved || has_failed);
    expect_valid(construction.mesh());
    (is_moved ? num_moved : num_unmoved) += has_failed;
  }
  EXPECT_GT(num_unmoved, 3);
  EXPECT_GT(num_moved, 0);
}

// Nodes whose masters already run end at once. They do not refine everything before they learn of the
// failure.
TEST(Threads, ThatCannotBeStartedEndTheRun) {
  const LabelImage image = ball(32, 13);
  const Isosurface isosurface(image, 1);
  const std::string path = testing::TempDir() + "/threads-" + std::to_string(getpid()) + ".log";
  const auto operations_of = [&](int threads_that_start) {
    OperationLogWriter log(path);
    const Team team{.coordination = {.num_workers = 4, .seed = 3}, .num_nodes = 4, .log = &log};
    StopControl stop({}, {}, [](std::uint64_t) {});
    const Problem problem{.isosurface = isosurface,
                          .object = foreground_bounds(image),
                          .delta_mm = 0.7,
                          .sizes = SizeField(std::vector<double>(2, 0.7)),
                          .cell_capacity = 1 << 22};
    threads_left = threads_that_start;
    try {
      pdr(problem, team, {.size_mm = 4}, stop);
      EXPECT_LT(threads_that_start, 0) << "a thread that could not be started went unnoticed";
    } catch (const std::exception&) {
      EXPECT_GE(threads_that_start, 0);
      EXPECT_EQ(stop.reason(), StopReason::kCancelled);
    }
    threads_left = -1;
    log.finish({{0, 0, 0, 1, 1, 1}, "", "RAS", ""});
    log.publish();
    return read_operation_log(path).all.operations.size();
  };
  const std::size_t all = operations_of(-1);
  for (const int threads : {0, 1, 2})
    EXPECT_LT(operations_of(threads), all / 2) << threads << " of 3 started";
}

INSTANTIATE_TEST_SUITE_P(Executors, RelocationFaults, testing::Values(Executor::kThreads, Executor::kVirtual),
                         [](const auto& test) { return to_string(test.param); });
INSTANTIATE_TEST_SUITE_P(Setups, Faults, testing::ValuesIn(kSetups), [](const auto& test) {
  const Setup& setup = test.param;
  std::string name = to_string(setup.algorithm) + to_string(setup.executor) +
                     std::to_string(setup.num_workers) + "on" + std::to_string(setup.numa_nodes) +
                     (setup.has_perturbation ? "perturbed" : "");
  std::erase(name, '-');
  return name;
});

}  // namespace
}  // namespace podm::test
