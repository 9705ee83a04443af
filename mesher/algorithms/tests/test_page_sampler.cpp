// Page samples of runs on made-up machines, whose system is a fake.
#include "algorithms/page_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "runtime/tests/machines.h"
#include "tests/run_on_machine.h"

namespace podm::test {
namespace {

// Answers of a made-up system: the whole image and transform are on the last node, all other pages on the
// nodes in turn, by address.
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
      EXPECT_EQ(arrays, (std::vector<std::string>{"cells", "vertices", "image", "transform"}));
      EXPECT_EQ(of_array(at, "image").elsewhere + of_array(at, "transform").elsewhere, 0u)
          << "their owners are who had them before";
      EXPECT_GT(of_array(at, "cells").elsewhere, 0u) << "the fake knows no pools";
      EXPECT_EQ(at.accesses_by_hops.size(), 3u);
    }
    EXPECT_EQ(sampled, phases);
    EXPECT_GT(total(refinement.pages.phases.front().accesses_by_hops), 0u);
    EXPECT_EQ(refinement.counters.hops.image_reads[0], 0u) << "workers are on the first two nodes";
    EXPECT_GT(refinement.counters.hops.image_reads[1], 0u) << "the first is beside the last";
  }
}

// A store whose pages are where the pools claim, then all one node further; a refusal; and memory without
// owner.
TEST(Pages, AreJudgedAgainstTheirOwnersAndAccessors) {
  const Topology machine = four_nodes();
  RunOn run(machine, 16);
  const Refinement refinement = run(Algorithm::kPodm, Executor::kVirtual, fake_pages(run));
  const Mesh& mesh = *refinement.mesh;
  std::map<const void*, int> owner;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) owner[&mesh.cell(c)] = mesh.node_of_cell(c);
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
  for (const char* array : {"cells", "vertices"}) {
    EXPECT_GT(of_array(in_place, array).as_claimed, 0u);
    EXPECT_EQ(of_array(in_place, array).elsewhere, 0u);
    EXPECT_EQ(of_array(moved, array).elsewhere, of_array(in_place, array).as_claimed);
    EXPECT_EQ(of_array(moved, array).as_claimed, 0u);
    EXPECT_EQ(of_array(nowhere, array).untouched, of_array(in_place, array).as_claimed);
  }
  EXPECT_EQ(in_place.accesses_by_hops, (std::vector<std::uint64_t>{4, 8, 4})) << "a ring of four";
  EXPECT_EQ(total(moved.accesses_by_hops), 16u);
  EXPECT_EQ(total(nowhere.accesses_by_hops), 0u);
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
  EXPECT_EQ(total(refinement.counters.hops.image_reads), 0u);
  EXPECT_GT(total(refinement.counters.hops.mesh_reads), 0u) << "whose owners the pools know";
}

}  // namespace
}  // namespace podm::test
