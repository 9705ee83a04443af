// Cavities filled by search: cells that are found fill the cavity and are good enough, and none are found
// where there are none.
#include "optimize/cavity_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace podm::test {
namespace {

const OptimizationQuality kQuality(DihedralBounds(8, 165));
constexpr LabelBound kAnySize(1e300);

double six_volumes(const std::vector<Point>& p, const LocalCell& c) {
  return dot(cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]]), p[c[3]] - p[c[0]]);
}

// Returns the facets that the cells have on one side only, as seen from inside.
std::vector<LocalFacet> boundary_of(const std::vector<LocalCell>& cells) {
  std::map<std::array<Local, 3>, std::vector<LocalFacet>> by_vertices;
  for (const LocalCell& cell : cells) {
    for (unsigned k = 0; k < 4; ++k) {
      LocalFacet key = facet_of(cell, k);
      std::sort(key.begin(), key.end());
      by_vertices[key].push_back(facet_of(cell, k));
    }
  }
  std::vector<LocalFacet> boundary;
  for (const auto& [key, sides] : by_vertices)
    if (sides.size() == 1) boundary.push_back(sides[0]);
  return boundary;
}

// Rotates each facet so that it begins with its least vertex.
std::vector<LocalFacet> normalized(std::vector<LocalFacet> facets) {
  for (LocalFacet& f : facets) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  std::sort(facets.begin(), facets.end());
  return facets;
}

void expect_filled(const CavitySearch& search, const std::vector<Point>& points,
                   const std::vector<LocalFacet>& boundary, double floor) {
  EXPECT_EQ(normalized(boundary_of(search.cells())), normalized(boundary));
  for (const LocalCell& c : search.cells()) {
    EXPECT_GT(six_volumes(points, c), 0);
    EXPECT_GT(kQuality.of({points[c[0]], points[c[1]], points[c[2]], points[c[3]]}), floor);
  }
}

// A bad diagonal: four cells around the long axis of a stretched octahedron.
TEST(CavitySearch, FindsTheBetterDiagonalOfAnOctahedron) {
  const std::vector<Point> points{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1.3}, {0, 0, -1.3}};
  const std::vector<LocalCell> around_the_axis{{5, 4, 0, 1}, {5, 4, 1, 2}, {5, 4, 2, 3}, {5, 4, 3, 0}};
  const auto boundary = boundary_of(around_the_axis);
  const double before = kQuality.of({points[5], points[4], points[0], points[1]});
  CavitySearch search(kQuality);
  search.begin(kAnySize);
  ASSERT_TRUE(search.fill(points, {}, boundary, before / 2, 1000));
  expect_filled(search, points, boundary, before / 2);
}

// Schoenhardt's polyhedron, a twisted prism: tetrahedra cannot fill it without an additional vertex.
TEST(CavitySearch, FillsSchoenhardtsPolyhedronByAnAddedVertexAlone) {
  std::vector<Point> points;
  for (const double z : {0.0, 1.0}) {
    for (int i = 0; i < 3; ++i) {
      const double t = (120 * i + 15 * z) * std::numbers::pi / 180;
      points.push_back({std::cos(t), std::sin(t), 1.3 * z});
    }
  }
  std::vector<LocalFacet> boundary{{0, 1, 2}, {3, 5, 4}};
  for (Local i = 0; i < 3; ++i) {
    const auto j = static_cast<Local>((i + 1) % 3);
    // The twist bends these diagonals inwards.
    boundary.push_back({i, static_cast<Local>(j + 3), j});
    boundary.push_back({i, static_cast<Local>(i + 3), static_cast<Local>(j + 3)});
  }
  CavitySearch search(kQuality);
  search.begin(kAnySize);
  EXPECT_FALSE(search.fill(points, {}, boundary, 0, 100000));
  search.begin(kAnySize);
  std::vector<LocalFacet> other{{0, 1, 2}, {3, 5, 4}};
  for (Local i = 0; i < 3; ++i) {
    const auto j = static_cast<Local>((i + 1) % 3);
    other.push_back({i, static_cast<Local>(i + 3), j});
    other.push_back({j, static_cast<Local>(i + 3), static_cast<Local>(j + 3)});
  }
  EXPECT_TRUE(search.fill(points, {}, other, 0, 100000))
      << "the other diagonals, bent outwards, can be filled";
  search.begin(kAnySize);
  const Point center{0, 0, 0.65};
  ASSERT_TRUE(search.fill(points, center, boundary, 0, 100000));
  points.push_back(center);
  expect_filled(search, points, boundary, 0);
}

TEST(CavitySearch, LeavesOutAVertexInsideThatSpoilsCells) {
  const std::vector<Point> points{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0.33, 0.33, -0.32}};
  const LocalCell whole =
      six_volumes(points, {0, 1, 2, 3}) > 0 ? LocalCell{0, 1, 2, 3} : LocalCell{1, 0, 2, 3};
  const auto boundary = boundary_of({whole});
  CavitySearch search(kQuality);
  search.begin(kAnySize);
  ASSERT_TRUE(search.fill(points, {}, boundary, 1, 1000));
  EXPECT_EQ(search.cells().size(), 1);
}

TEST(CavitySearch, KeepsTheBoundOnSize) {
  const std::vector<Point> points{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const LocalCell whole =
      six_volumes(points, {0, 1, 2, 3}) > 0 ? LocalCell{0, 1, 2, 3} : LocalCell{1, 0, 2, 3};
  CavitySearch search(kQuality);
  for (const bool is_large : {true, false}) {
    search.begin(LabelBound(is_large ? 3.01 : 2.99));  // the squared radius is 3
    EXPECT_EQ(search.fill(points, {}, boundary_of({whole}), 0, 1000), is_large);
  }
}

TEST(CavitySearch, GivesUpAfterSoManySteps) {
  std::vector<Point> points;
  std::vector<LocalCell> cells;
  for (int i = 0; i < 12; ++i)
    points.push_back({std::cos(i * std::numbers::pi / 6), std::sin(i * std::numbers::pi / 6), 0});
  points.push_back({0, 0, -0.5});
  points.push_back({0, 0, 0.5});
  for (Local i = 0; i < 12; ++i) cells.push_back({12, 13, i, static_cast<Local>((i + 1) % 12)});
  CavitySearch search(kQuality);
  search.begin(kAnySize);
  EXPECT_FALSE(search.fill(points, {}, boundary_of(cells), 0, 3));
  EXPECT_EQ(search.num_steps(), 3);
}

}  // namespace
}  // namespace podm::test
