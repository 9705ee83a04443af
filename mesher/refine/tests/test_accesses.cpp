// Accesses by kind and distance, and page samples, on machines that are made up: hwloc's synthetic
// topologies, and page answers of a fake.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "../../runtime/tests/machines.h"
#include "algorithms/podm.h"
#include "cost_model.h"
#include "image_owners.h"
#include "images.h"
#include "page_sampler.h"
#include "refine/virtual_box.h"

namespace podm::test {
namespace {

constexpr std::vector<std::uint64_t> HopsByKind::*kKinds[] = {
    &HopsByKind::mesh_reads, &HopsByKind::mesh_writes, &HopsByKind::image_reads,
    &HopsByKind::transform_reads};

std::uint64_t sum(const std::vector<std::uint64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

// One worker a core, node after node, of a run of this image on that machine.
struct RunOn {
  RunOn(const Topology& of_run, int num_workers)
      : machine(of_run),
        placement{.machine = of_run,
                  .places = place_workers(of_run, {}, num_workers, true),
                  .groups = {},
                  .is_real = false} {
    for (Place& place : placement.places) place.processor.reset();
  }

  Refinement operator()(Algorithm algorithm, Executor executor, const PageQuery& query = nullptr,
                        bool with_owners = true) {
    placement.is_real = query != nullptr;
    owners.emplace(owners_of_image(image, isosurface.transform(), placement, 1, query));
    const PageSampler pages(machine, *owners, query);
    const auto num_workers = static_cast<int>(placement.places.size());
    const Team team{.executor = executor,
                    .coordination = {.num_workers = num_workers},
                    .num_nodes = 2,
                    .initial_workers = num_workers,
                    .machine = &machine,
                    .places = placement.places,
                    .owners = with_owners ? &*owners : nullptr,
                    .pages = query ? &pages : nullptr};
    const Problem problem{.isosurface = isosurface,
                          .object = foreground_bounds(image),
                          .delta_mm = 1,
                          .sizes = SizeField({2, 2}),
                          .cell_capacity = 1 << 22};
    StopControl stop({}, {}, [](std::uint64_t) {});
    if (algorithm == Algorithm::kPodm) return podm(problem, team, stop);
    return pdr_podm(problem, team, {}, stop);
  }

  const Topology& machine;
  PlacementOfTeam placement;
  LabelImage image = ball(24, 9);
  Isosurface isosurface{image, 1};
  std::optional<ImageOwners> owners;
};

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
    EXPECT_GE(sum(hops.mesh_reads), refinement.counters.conflict_tests);
    // A star's cells are made, and every facet but those of the box is glued.
    EXPECT_GE(sum(hops.mesh_writes), refinement.counters.cells_created);
    EXPECT_GE(sum(hops.transform_reads), refinement.counters.classified_cells);
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
      continue;  // slots of other nodes' cells are emptied, own ones refilled
    EXPECT_EQ(sum(on_ring.counters.hops.*kind), sum(on_pair.counters.hops.*kind));
  }
  EXPECT_GT(sum(on_ring.counters.hops.mesh_writes), sum(on_pair.counters.hops.mesh_writes));
}

TEST(Accesses, AreNotCountedOnOneNode) {
  const Topology machine = one_node();
  const Refinement refinement = RunOn(machine, 8)(Algorithm::kPodm, Executor::kVirtual);
  for (const auto kind : kKinds) EXPECT_TRUE((refinement.counters.hops.*kind).empty());
}

// Vertices in their order: what the run did, to the bit.
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
    EXPECT_EQ(sum(uncounted.counters.hops.image_reads), 0u) << "of an image whose owners are unknown";
  }
}

// Answers of a made-up system: all of image and transform is on the last node, the rest by address, in turn.
PageQuery fake_pages(const RunOn& run) {
  const auto is_in = [](const void* address, auto array) {
    return address >= array.data() && address < array.data() + array.size();
  };
  return [&run, is_in](std::span<const void* const> addresses) {
    PageNodes nodes;
    for (const void* address : addresses) {
      const bool is_shared =
          is_in(address, std::span(run.image.voxels)) || is_in(address, run.isosurface.transform().words());
      nodes.os_indices.push_back(
          is_shared ? 3 : static_cast<int>(reinterpret_cast<std::uintptr_t>(address) >> 16 & 3));
    }
    return nodes;
  };
}

const PageSamples::OfArray& of_array(const PageSamples::AtPhase& at, const std::string& name) {
  return *std::find_if(at.arrays.begin(), at.arrays.end(),
                       [&](const auto& pages) { return pages.array == name; });
}

TEST(Pages, AreSampledOfTheWholeStoreAtTheEndOfEachPhase) {
  const Topology machine = four_nodes();
  for (const auto& [algorithm, phases] :
       {std::pair{Algorithm::kPodm, std::vector<std::string>{"refine"}},
        {Algorithm::kPdrPodm, std::vector<std::string>{"initial", "refine", "closing"}}}) {
    RunOn run(machine, 8);
    const Refinement refinement = run(algorithm, Executor::kThreads, fake_pages(run));
    EXPECT_EQ(refinement.pages.unavailable, "");
    std::vector<std::string> sampled;
    for (const PageSamples::AtPhase& at : refinement.pages.phases) {
      sampled.push_back(at.phase);
      std::vector<std::string> arrays;
      for (const PageSamples::OfArray& pages : at.arrays) {
        arrays.push_back(pages.array);
        EXPECT_GT(pages.as_claimed + pages.elsewhere, 0u) << pages.array;
        EXPECT_EQ(pages.untouched, 0u);
        EXPECT_LE(pages.as_claimed + pages.elsewhere, 2000u);
      }
      EXPECT_EQ(arrays, (std::vector<std::string>{"cells", "cell_states", "vertices", "image", "transform"}));
      EXPECT_EQ(of_array(at, "image").elsewhere + of_array(at, "transform").elsewhere, 0u)
          << "their owners are who had them before";
      EXPECT_GT(of_array(at, "cells").elsewhere, 0u) << "the fake knows no pools";
      EXPECT_EQ(at.accesses_by_hops.size(), 3u);
    }
    EXPECT_EQ(sampled, phases);
    EXPECT_GT(sum(refinement.pages.phases.front().accesses_by_hops), 0u);
    EXPECT_EQ(refinement.counters.hops.image_reads[0], 0u) << "workers are on the first two nodes";
    EXPECT_GT(refinement.counters.hops.image_reads[1], 0u) << "the first is beside the last";
  }
}

// A store whose pages lie where the pools say, then all one node further; a refusal; and memory of nobody.
TEST(Pages, AreJudgedAgainstTheirOwnersAndAccessors) {
  const Topology machine = four_nodes();
  RunOn run(machine, 16);
  const Refinement refinement = run(Algorithm::kPodm, Executor::kVirtual, fake_pages(run));
  const Mesh& mesh = *refinement.mesh;
  std::map<const void*, int> owner;
  for (CellId c = 0; c < mesh.cell_bound(); ++c)
    owner[&mesh.cell(c)] = owner[&mesh.state(c)] = mesh.node_of_cell(c);
  for (VertexId v = 0; v < mesh.vertex_bound(); ++v) owner[&mesh.vertex(v)] = mesh.node_of_vertex(v);

  std::vector<SampledAccesses> accesses;  // each node's worker reads a cell of each node
  for (int node = 0; node < machine.num_nodes(); ++node) {
    accesses.push_back({node, {}});
    for (int other = 0; other < machine.num_nodes(); ++other)
      accesses.back().addresses.push_back(
          std::find_if(owner.begin(), owner.end(), [&](const auto& x) { return x.second == other; })->first);
  }
  const auto sample = [&](const std::function<int(int)>& node_of_owner) {
    const PageQuery query = [&](std::span<const void* const> addresses) {
      PageNodes nodes;
      for (const void* address : addresses)
        nodes.os_indices.push_back(owner.contains(address) ? node_of_owner(owner.at(address)) : 0);
      return nodes;
    };
    PageSamples samples;
    PageSampler(machine, *run.owners, query).sample("refine", mesh, accesses, samples);
    return samples.phases.at(0);
  };
  const auto in_place = sample([](int node) { return node; }),
             moved = sample([](int node) { return (node + 1) % 4; }),
             nowhere = sample([](int) { return PageNodes::kNowhere; });
  for (const char* array : {"cells", "cell_states", "vertices"}) {
    EXPECT_GT(of_array(in_place, array).as_claimed, 0u);
    EXPECT_EQ(of_array(in_place, array).elsewhere, 0u);
    EXPECT_EQ(of_array(moved, array).elsewhere, of_array(in_place, array).as_claimed);
    EXPECT_EQ(of_array(moved, array).as_claimed, 0u);
    EXPECT_EQ(of_array(nowhere, array).untouched, of_array(in_place, array).as_claimed);
  }
  EXPECT_EQ(in_place.accesses_by_hops, (std::vector<std::uint64_t>{4, 8, 4})) << "a ring of four";
  EXPECT_EQ(sum(moved.accesses_by_hops), 16u);
  EXPECT_EQ(sum(nowhere.accesses_by_hops), 0u);
}

TEST(Pages, AreAskedNoMoreOnceTheSystemRefuses) {
  const Topology machine = four_nodes();
  int num_queries = 0;
  const Refinement refinement =
      RunOn(machine, 8)(Algorithm::kPdrPodm, Executor::kThreads, [&](std::span<const void* const>) {
        ++num_queries;
        return PageNodes{{}, "not in this container"};
      });
  EXPECT_EQ(refinement.pages.unavailable, "not in this container");
  EXPECT_TRUE(refinement.pages.phases.empty());
  EXPECT_EQ(num_queries, 3) << "image, transform, and the store once";
  EXPECT_EQ(sum(refinement.counters.hops.image_reads), 0u);
  EXPECT_GT(sum(refinement.counters.hops.mesh_reads), 0u) << "whose owners the pools know";
}

}  // namespace
}  // namespace podm::test
