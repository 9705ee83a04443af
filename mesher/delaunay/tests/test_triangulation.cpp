// Properties of the kernel alone: validity, uniqueness, and that a removal undoes an insertion.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "triangulator.h"

namespace podm::test {
namespace {

const Box kBox{{-10, -10, -10}, {10, 10, 10}};

struct PointSet {
  const char* name;
  std::function<std::vector<Point>()> make;
};

std::vector<Point> random_points(unsigned seed, int n, double scale, Point center = {0, 0, 0}) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-scale, scale);
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    points.push_back(center + Point{uniform(random), uniform(random), uniform(random)});
  }
  return points;
}

std::vector<Point> grid(int n) {
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) points.push_back({i * 1.0 - n / 2, j * 1.0 - n / 2, k * 1.0 - n / 2});
    }
  }
  return points;
}

std::vector<Point> shuffled(std::vector<Point> points, unsigned seed) {
  std::shuffle(points.begin(), points.end(), std::mt19937_64(seed));
  return points;
}

// Exactly representable points of one sphere: permutations and signs of Pythagorean quadruples with r = 9
// and 3.
std::vector<Point> cospherical() {
  std::vector<Point> points;
  for (const Point q : {Point{1, 4, 8}, Point{4, 4, 7}, Point{0, 0, 9}, Point{3, 6, 6}}) {
    for (int signs = 0; signs < 8; ++signs) {
      for (int turn = 0; turn < 3; ++turn) {
        Point p = turn == 0 ? q : turn == 1 ? Point{q.y, q.z, q.x} : Point{q.z, q.x, q.y};
        if (signs & 1) p.x = -p.x;
        if (signs & 2) p.y = -p.y;
        if (signs & 4) p.z = -p.z;
        if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
      }
    }
  }
  return points;
}

std::vector<Point> collinear() {
  std::vector<Point> points;
  for (int i = -40; i <= 40; ++i) points.push_back({i * 0.125, 0.5 * i * 0.125, -0.25 * i * 0.125});
  return points;
}

std::vector<Point> coplanar() {
  std::vector<Point> points = random_points(5, 200, 8);
  for (Point& p : points) p.z = 1;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) points.push_back({i * 1.0, j * 1.0, 1});
  }
  return points;
}

std::vector<Point> clustered() {
  std::vector<Point> points;
  for (unsigned c = 0; c < 5; ++c) {
    const Point center = random_points(100 + c, 1, 8)[0];
    for (const Point& p : random_points(c, 60, std::pow(10.0, -2.0 * c), center)) points.push_back(p);
  }
  return points;
}

std::vector<Point> nearly_degenerate() {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> ulps(-2, 2);
  std::vector<Point> points = grid(6);
  for (Point& p : points) {
    p.x += ulps(random) * 0x1p-51;
    p.y += ulps(random) * 0x1p-51;
    p.z += ulps(random) * 0x1p-51;
  }
  return points;
}

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
  ASSERT_EQ(combined.operation.commit_insertion(last, VertexKind::kIsosurface, 0), Outcome::kCommitted);
  for (const Point& p : points) {
    if (std::find(removed.begin(), removed.end(), p) == removed.end()) expected.insert(p);
  }
  std::string fault;
  EXPECT_TRUE(is_valid(combined.mesh, &fault)) << fault;
  EXPECT_EQ(combined.cells(), expected.cells());
}

INSTANTIATE_TEST_SUITE_P(PointSets, Triangulation,
                         testing::Values(PointSet{"random", [] { return random_points(1, 500, 9); }},
                                         PointSet{"grid", [] { return grid(7); }},
                                         PointSet{"cospherical", cospherical},
                                         PointSet{"collinear", collinear}, PointSet{"coplanar", coplanar},
                                         PointSet{"clustered", clustered},
                                         PointSet{"nearly_degenerate", nearly_degenerate}),
                         [](const auto& point_set) { return std::string(point_set.param.name); });

TEST(TriangulationEdge, CoincidentPointIsRejectedAndNothingChanges) {
  Triangulator t(kBox);
  for (const Point& p : random_points(2, 50, 9)) t.insert(p);
  const auto before = t.cells();
  const Point p = t.mesh.point(20);
  EXPECT_EQ(t.operation.plan_insertion(p, t.cell_around(20)), Outcome::kRejected);
  t.operation.rollback();
  EXPECT_EQ(t.cells(), before);
  EXPECT_TRUE(is_valid(t.mesh));
}

TEST(TriangulationEdge, PointTooNearIsRejectedAndNothingChanges) {
  Triangulator t(kBox);
  for (const Point& p : random_points(2, 50, 9)) t.insert(p);
  const auto before = t.cells();
  const Point p = t.mesh.point(20) + Point{1e-6, 0, 0};
  ASSERT_EQ(t.operation.plan_insertion(p, t.conflicting_cell(p)), Outcome::kCommitted);
  EXPECT_EQ(t.operation.commit_insertion(p, VertexKind::kIsosurface, 1e-5), Outcome::kRejected);
  t.operation.rollback();
  EXPECT_EQ(t.cells(), before);
  EXPECT_TRUE(is_valid(t.mesh));
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
