// Every count is summed. Accesses are counted by kind and distance, in runs on made-up machines.
#include "algorithms/report_on_workers.h"

#include <gtest/gtest.h>

#include "runtime/tests/machines.h"
#include "tests/run_on_machine.h"

namespace podm::test {
namespace {

constexpr std::vector<std::uint64_t> HopsByKind::*kKinds[] = {
    &HopsByKind::mesh_reads, &HopsByKind::mesh_writes, &HopsByKind::image_reads,
    &HopsByKind::transform_reads};

TEST(SumOfWorkers, HasEveryCountAndCause) {
  std::vector<WorkerReport> workers(2);
  std::uint64_t n = 0;
  for (WorkerReport& worker : workers) {
    for (std::uint64_t& insertions : worker.counters.insertions_by_rule) insertions = ++n;
    for (const Count& count : kCounts) worker.counters.*count.member = ++n;
    for (const Cause& cause : kCauses) worker.counters.overhead.*cause.member = static_cast<double>(++n);
  }
  const Counters sum = sum_of(workers), &one = workers[0].counters, &other = workers[1].counters;
  EXPECT_EQ(sum.num_committed(), one.num_committed() + other.num_committed());
  for (const Count& count : kCounts)
    EXPECT_EQ(sum.*count.member, one.*count.member + other.*count.member) << count.name;
  for (const Cause& cause : kCauses)
    EXPECT_EQ(sum.overhead.*cause.member, one.overhead.*cause.member + other.overhead.*cause.member)
        << cause.name;
}

TEST(Accesses, OfEveryKindAreCountedByDistance) {
  const Topology machine = four_nodes();
  for (const Algorithm algorithm : {Algorithm::kPodm, Algorithm::kPdrPodm}) {
    RunOn run(machine, 16);
    const Refinement refinement = run(algorithm, Executor::kVirtual);
    for (const auto kind : kKinds) {
      const std::vector<std::uint64_t>& all = refinement.counters.hops.*kind;
      ASSERT_EQ(all.size(), 3u) << "0, 1 and 2 hops";
      EXPECT_GT(all[0], 0u);
      std::vector<std::uint64_t> of_workers(3);
      for (const WorkerReport& worker : refinement.workers)
        for (std::size_t hops = 0; hops < 3; ++hops) of_workers[hops] += (worker.counters.hops.*kind)[hops];
      EXPECT_EQ(all, of_workers);
    }
    const HopsByKind& hops = refinement.counters.hops;
    EXPECT_GE(total(hops.mesh_reads), refinement.counters.conflict_tests);
    // The cells of a star are made, and every facet except those of the box is glued.
    EXPECT_GE(total(hops.mesh_writes), refinement.counters.cells_created);
    EXPECT_GE(total(hops.transform_reads), refinement.counters.classified_cells);
  }
}

TEST(Accesses, DoNotDependOnWhereWorkersStandButTheirDistancesDo) {
  const Topology ring = four_nodes(), pair = Topology::synthetic("numa:2 core:8 pu:1");
  const Refinement on_ring = RunOn(ring, 16)(Algorithm::kPodm, Executor::kVirtual),
                   on_pair = RunOn(pair, 16)(Algorithm::kPodm, Executor::kVirtual),
                   again = RunOn(ring, 16)(Algorithm::kPodm, Executor::kVirtual);
  for (const auto kind : kKinds) {
    EXPECT_LT((on_ring.counters.hops.*kind)[0], (on_pair.counters.hops.*kind)[0])
        << "more is near on fewer nodes";
    EXPECT_EQ(on_ring.counters.hops.*kind, again.counters.hops.*kind) << "the same for the same seed";
    if (kind == &HopsByKind::mesh_writes)
      continue;  // slots of other nodes' cells are emptied, own slots are refilled
    EXPECT_EQ(total(on_ring.counters.hops.*kind), total(on_pair.counters.hops.*kind));
  }
  EXPECT_GT(total(on_ring.counters.hops.mesh_writes), total(on_pair.counters.hops.mesh_writes));
}

TEST(Accesses, AreNotCountedOnOneNode) {
  const Topology machine = one_node();
  const Refinement refinement = RunOn(machine, 8)(Algorithm::kPodm, Executor::kVirtual);
  for (const auto kind : kKinds) EXPECT_TRUE((refinement.counters.hops.*kind).empty());
}

// The vertices in order: the result of the run, to the bit.
std::vector<Point> points_of(const Mesh& mesh) {
  std::vector<Point> points;
  for (VertexId v = 0; v < mesh.vertex_bound(); ++v) points.push_back(mesh.point(v));
  return points;
}

TEST(Accesses, CountingChangesNothing) {
  const Topology machine = four_nodes();
  for (const Algorithm algorithm : {Algorithm::kPodm, Algorithm::kPdrPodm}) {
    const Refinement counted = RunOn(machine, 16)(algorithm, Executor::kVirtual),
                     uncounted = RunOn(machine, 16)(algorithm, Executor::kVirtual, nullptr, false);
    EXPECT_EQ(points_of(*counted.mesh), points_of(*uncounted.mesh));
    EXPECT_EQ(counted.counters.hops.mesh_reads, uncounted.counters.hops.mesh_reads);
    EXPECT_EQ(total(uncounted.counters.hops.image_reads), 0u) << "of an image whose owners are unknown";
  }
}

}  // namespace
}  // namespace podm::test
