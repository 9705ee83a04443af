// A mesh that moves to other NUMA nodes stays the same mesh, and lies on the requested nodes.
#include <gtest/gtest.h>

#include <set>

#include "cells_by_points.h"
#include "delaunay/operation.h"
#include "delaunay/relocation.h"
#include "delaunay/tests/validity.h"
#include "point_sets.h"
#include "runtime/parallel_for.h"

namespace podm::test {
namespace {

constexpr int kNodesOfMesh = 4;
const std::vector<NodeIndex> kNodes{0, 0, 0, 1, 3};  // per worker; node 2 has none

// A triangulation that workers of three nodes made in turn, with vertices and cells released by other
// workers.
class Relocated : public testing::Test {
 protected:
  Relocated() {
    for (const NodeIndex node : kNodes) pools_.emplace_back(mesh_, node, kNodes.size());
    for (WorkerId self = 0; self < kNodes.size(); ++self)
      operations_.push_back(std::make_unique<Operation<NoLocks>>(mesh_, pools_[self], self));
    const std::vector<Point> points = random_points(1, 2'000, 9);
    for (std::size_t i = 0; i < points.size(); ++i) insert(points[i], i % kNodes.size());
  }

  void insert(const Point& p, std::size_t worker) {
    CellId start = mesh_.cell_bound() - 1;
    while (!mesh_.cell(start).is_alive() || !mesh_.is_in_conflict(start, p)) --start;
    operations_[worker]->plan_insertion(p, start);
    ASSERT_EQ(operations_[worker]->commit_insertion(p, VertexKind::kCircumcenter, 1e-100), StepResult::kDone);
  }
  // Assigns nodes by slabs. One slab stays where it is.
  static NodeIndex node_of(const Point& p) {
    return p.x < -5 ? 0 : p.x < 0 ? 1 : p.x < 5 ? 3 : Relocation::kStay;
  }
  std::unique_ptr<Relocation> relocate(std::size_t threads, double sign = 1) {
    auto relocation = std::make_unique<Relocation>(mesh_, kNodes);
    const auto by_all = [&](const auto& step) {
      parallel_for(kNodes.size(), threads,
                   [&](std::size_t i, std::size_t) { step(static_cast<WorkerId>(i)); });
    };
    by_all([&](WorkerId self) { relocation->look(self, [&](const Point& p) { return node_of(sign * p); }); });
    by_all([&](WorkerId self) { relocation->rename(self, pools_[self]); });
    by_all([&](WorkerId self) { relocation->move(self, pools_[self]); });
    return relocation;
  }

  Mesh mesh_{kBox, 1 << 20, kNodesOfMesh};
  std::vector<Pool> pools_;
  std::vector<std::unique_ptr<Operation<NoLocks>>> operations_;
};

TEST_F(Relocated, IsTheSameMesh) {
  for (const std::size_t threads : {1, 4, 4}) {
    const auto before = cells_by_points(mesh_);
    relocate(threads);
    std::string fault;
    EXPECT_TRUE(is_valid(mesh_, &fault)) << fault;
    EXPECT_EQ(cells_by_points(mesh_), before);
  }
}

TEST_F(Relocated, LiesWhereItWasMovedTo) {
  std::vector<NodeIndex> of_cell, of_vertex;
  for (CellId c = 0; c < mesh_.cell_bound(); ++c) of_cell.push_back(mesh_.node_of_cell(c));
  for (VertexId v = 0; v < mesh_.vertex_bound(); ++v) of_vertex.push_back(mesh_.node_of_vertex(v));
  const auto relocation = relocate(2);
  std::set<NodeIndex> nodes;
  for (CellId c = 0; c < of_cell.size(); ++c) {
    const CellId now = relocation->cell_now(c);
    if (!mesh_.cell(now).is_alive()) continue;
    const NodeIndex asked = node_of(mesh_.cell(now).center);
    EXPECT_EQ(mesh_.node_of_cell(now), asked == Relocation::kStay ? of_cell[c] : asked);
    EXPECT_TRUE(now == c || !mesh_.cell(c).is_alive());
    nodes.insert(mesh_.node_of_cell(now));
  }
  for (VertexId v = 0; v < of_vertex.size(); ++v) {
    const VertexId now = relocation->vertex_now(v);
    if (mesh_.vertex(now).kind == VertexKind::kUnused) continue;
    const NodeIndex asked = node_of(mesh_.point(now));
    EXPECT_EQ(mesh_.node_of_vertex(now), asked == Relocation::kStay ? of_vertex[v] : asked);
    EXPECT_TRUE(now == v || mesh_.vertex(v).kind == VertexKind::kUnused);
  }
  EXPECT_EQ(nodes, (std::set<NodeIndex>{0, 1, 3}));
}

// Old ids are reused; no new ids are needed.
TEST_F(Relocated, IsGoneOnWith) {
  relocate(1);
  const CellId bound = mesh_.cell_bound();
  const std::vector<Point> points = random_points(2, 500, 9);
  for (std::size_t i = 0; i < points.size(); ++i) insert(points[i], i % kNodes.size());
  std::string fault;
  EXPECT_TRUE(is_valid(mesh_, &fault)) << fault;
  EXPECT_EQ(mesh_.cell_bound(), bound);
}

// The mesh moves from side to side repeatedly: the old ids are used again.
TEST_F(Relocated, TakesNoMoreRoomInTheEnd) {
  for (int i = 0; i < 4; ++i) relocate(1, i % 2 == 0 ? -1 : 1);
  const CellId cells = mesh_.cell_bound();
  const VertexId vertices = mesh_.vertex_bound();
  for (int i = 0; i < 60; ++i) relocate(1, i % 2 == 0 ? -1 : 1);
  EXPECT_LE(mesh_.cell_bound(), 2 * cells);
  EXPECT_LE(mesh_.vertex_bound(), 2 * vertices);
}

// A list entry from before the move finds another stamp, or no cell.
TEST_F(Relocated, IsNotTakenForWhatItWas) {
  std::vector<std::uint16_t> stamps;
  for (CellId c = 0; c < mesh_.cell_bound(); ++c) stamps.push_back(mesh_.stamp(c));
  const auto relocation = relocate(1);
  for (CellId c = 0; c < stamps.size(); ++c)
    EXPECT_TRUE(relocation->cell_now(c) == c || mesh_.stamp(c) != stamps[c]) << c;
}

}  // namespace
}  // namespace podm::test
