// Properties of the kernel alone: validity, uniqueness, and a removal undoes an insertion.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "delaunay/hole.h"
#include "delaunay/tests/validity.h"
#include "delaunay/walk.h"
#include "point_sets.h"
#include "triangulator.h"

namespace podm::test {
namespace {

class Triangulation : public testing::TestWithParam<PointSet> {};

TEST_P(Triangulation, IsValidAndUnique) {
  const std::vector<Point> points = GetParam().make();
  Triangulator first(kBox), second(kBox);
  for (const Point& p : shuffled(points, 1)) ASSERT_TRUE(first.insert(p));
  for (const Point& p : shuffled(points, 2)) ASSERT_TRUE(second.insert(p));
  std::string fault;
  EXPECT_TRUE(is_valid(first.mesh, &fault)) << fault;
  EXPECT_EQ(first.cells(), second.cells());
}

TEST_P(Triangulation, RemovalUndoesInsertion) {
  const std::vector<Point> points = shuffled(GetParam().make(), 3);
  const std::size_t half = points.size() / 2;
  Triangulator t(kBox);
  for (std::size_t i = 0; i < half; ++i) t.insert(points[i]);
  const auto before = t.cells();
  std::vector<VertexId> added;
  for (std::size_t i = half; i < points.size(); ++i) added.push_back(*t.insert(points[i]));
  std::shuffle(added.begin(), added.end(), std::mt19937_64(4));
  std::string fault;
  for (const VertexId v : added) t.remove(v);
  ASSERT_TRUE(is_valid(t.mesh, &fault)) << fault;
  EXPECT_EQ(t.cells(), before);
}

TEST_P(Triangulation, CombinedOperationEqualsItsParts) {
  const std::vector<Point> points = shuffled(GetParam().make(), 5);
  Triangulator combined(kBox), expected(kBox);
  std::vector<Point> survivors;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) combined.insert(points[i]);
  const Point last = points.back();
  // Removes every vertex of the last point's cavity while inserting it, in one operation.
  combined.operation.plan_insertion(last, combined.conflicting_cell(last));
  std::vector<Point> removed;
  combined.operation.for_each_region_vertex([&](VertexId v, CellId seed) {
    if (combined.mesh.vertex(v).kind == VertexKind::kBox || combined.operation.removes(v)) return;
    if (removed.size() == 5) return;
    removed.push_back(combined.mesh.point(v));
    combined.operation.plan_removal(v, seed);
  });
  ASSERT_EQ(combined.operation.commit_insertion(last, VertexKind::kIsosurface, 0), StepResult::kDone);
  for (const Point& p : points) {
    if (std::find(removed.begin(), removed.end(), p) == removed.end()) expected.insert(p);
  }
  std::string fault;
  EXPECT_TRUE(is_valid(combined.mesh, &fault)) << fault;
  EXPECT_EQ(combined.cells(), expected.cells());
}

TEST_P(Triangulation, HasTheCellsAroundAVertexThatAWalkFinds) {
  Triangulator t(kBox);
  for (const Point& p : shuffled(GetParam().make(), 7)) t.insert(p);
  std::map<VertexId, CellId> a_cell_of;
  for (CellId c = 0; c < t.mesh.cell_bound(); ++c)
    if (t.mesh.cell(c).is_alive())
      for (const VertexId v : t.mesh.cell(c).vertices) a_cell_of.try_emplace(v, c);
  std::vector<CellId> ball;
  for (const auto& [v, first] : a_cell_of) {
    find_around_vertex(t.mesh, v, first, ball);
    EXPECT_EQ(ball.front(), first);
    std::sort(ball.begin(), ball.end());
    std::vector<CellId> expected;
    for (CellId c = first; c < t.mesh.cell_bound(); ++c)
      if (t.mesh.cell(c).is_alive() && t.mesh.cell(c).has(v)) expected.push_back(c);
    EXPECT_EQ(ball, expected);
    for (const CellId c : ball) EXPECT_FALSE(t.mesh.is_marked(c));
  }
}

// The kernel computes several spheres side by side; the reference computes one.
TEST_P(Triangulation, SpheresAreThoseOfTheFormulaToTheBit) {
  Triangulator t(kBox);
  for (const Point& p : shuffled(GetParam().make(), 6)) t.insert(p);
  for (CellId c = 0; c < t.mesh.cell_bound(); ++c) {
    const Cell& cell = t.mesh.cell(c);
    if (!cell.is_alive()) continue;
    const auto point = [&](unsigned i) { return t.mesh.point(cell.vertices[i]); };
    const Circumsphere sphere = circumsphere(point(0), point(1), point(2), point(3), t.mesh.extent());
    EXPECT_EQ(cell.center, sphere.center);
    const float stored = stored_squared_radius(sphere.squared_radius);
    EXPECT_TRUE(cell.squared_radius == stored || (std::isnan(cell.squared_radius) && std::isnan(stored)));
  }
}

INSTANTIATE_TEST_SUITE_P(PointSets, Triangulation, testing::ValuesIn(point_sets()),
                         [](const auto& point_set) { return std::string(point_set.param.name); });

TEST(TriangulationEdge, CoincidentPointIsRejectedAndNothingChanges) {
  Triangulator t(kBox);
  for (const Point& p : random_points(2, 50, 9)) t.insert(p);
  const auto before = t.cells();
  const Point p = t.mesh.point(20);
  EXPECT_EQ(t.operation.plan_insertion(p, t.cell_around(20)), StepResult::kNotInConflict);
  t.operation.rollback();
  EXPECT_EQ(t.cells(), before);
  EXPECT_TRUE(is_valid(t.mesh));
}

TEST(TriangulationEdge, PointTooNearIsRejectedAndNothingChanges) {
  Triangulator t(kBox);
  for (const Point& p : random_points(2, 50, 9)) t.insert(p);
  const auto before = t.cells();
  const Point p = t.mesh.point(20) + Point{1e-6, 0, 0};
  ASSERT_EQ(t.operation.plan_insertion(p, t.conflicting_cell(p)), StepResult::kDone);
  EXPECT_EQ(t.operation.commit_insertion(p, VertexKind::kIsosurface, 1e-5), StepResult::kTooNear);
  t.operation.rollback();
  EXPECT_EQ(t.cells(), before);
  EXPECT_TRUE(is_valid(t.mesh));
}

// The cavity of a point among many, planned by fillers that can number fewer vertices than it has, or as
// many.
TEST(TriangulationEdge, HoleOfMoreVerticesThanCanBeNumberedIsNotPlanned) {
  Triangulator t(kBox);
  for (const Point& p : random_points(4, 200, 9)) t.insert(p);
  const Point p{0.1, 0.2, 0.3};
  const Region region = t.region_of([&](CellId c) { return t.mesh.is_in_conflict(c, p); });
  std::set<VertexId> vertices;
  for (const CellId c : region.cells)
    vertices.insert(t.mesh.cell(c).vertices.begin(), t.mesh.cell(c).vertices.end());
  ASSERT_GT(vertices.size(), 8u);
  for (std::size_t room = 5; room <= vertices.size(); ++room)
    EXPECT_FALSE(HoleFiller(room).plan(t.mesh, region, &p)) << room;
  HoleFiller enough(vertices.size() + 1);
  EXPECT_TRUE(enough.plan(t.mesh, region, &p));
  EXPECT_EQ(enough.num_cells(), region.boundary.size()) << "the star of the point";
}

TEST(TriangulationEdge, ValidityCheckSeesDamage) {
  Triangulator t(kBox);
  for (const Point& p : random_points(3, 50, 9)) t.insert(p);
  std::string fault;
  t.mesh.vertex(20).point.x += 3;
  EXPECT_FALSE(is_valid(t.mesh, &fault));
  EXPECT_FALSE(fault.empty());
}

}  // namespace
}  // namespace podm::test
