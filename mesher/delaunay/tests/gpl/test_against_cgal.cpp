// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the kernel with CGAL's Delaunay triangulation (GPL). Kept apart from everything else and never
// installed.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include "delaunay/tests/point_sets.h"
#include "delaunay/tests/triangulator.h"

namespace podm::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Reference = CGAL::Delaunay_triangulation_3<Kernel>;
using CellPoints = std::array<std::array<double, 3>, 4>;

Kernel::Point_3 convert(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

std::vector<CellPoints> reference_cells(const Reference& reference) {
  std::vector<CellPoints> all;
  for (const auto cell : reference.finite_cell_handles()) {
    CellPoints points;
    for (int i = 0; i < 4; ++i) {
      const auto& p = cell->vertex(i)->point();
      points[static_cast<std::size_t>(i)] = {p.x(), p.y(), p.z()};
    }
    std::sort(points.begin(), points.end());
    all.push_back(points);
  }
  std::sort(all.begin(), all.end());
  return all;
}

bool is_empty_ball(const CellPoints& c, const Reference& reference) {
  const bool is_positive =
      CGAL::orientation(convert(c[0]), convert(c[1]), convert(c[2]), convert(c[3])) == CGAL::POSITIVE;
  for (const auto vertex : reference.finite_vertex_handles()) {
    if (CGAL::side_of_oriented_sphere(convert(c[is_positive ? 0 : 1]), convert(c[is_positive ? 1 : 0]),
                                      convert(c[2]), convert(c[3]),
                                      vertex->point()) == CGAL::ON_POSITIVE_SIDE) {
      return false;
    }
  }
  return true;
}

double volume(const std::vector<CellPoints>& cells) {
  double sum = 0;
  for (const auto& c : cells)
    sum += std::abs(CGAL::volume(convert(c[0]), convert(c[1]), convert(c[2]), convert(c[3])));
  return sum;
}

std::vector<CellPoints> away_from_corners(std::vector<CellPoints> cells) {
  std::erase_if(cells, [](const CellPoints& c) {
    return std::any_of(c.begin(), c.end(), [](const auto& p) { return std::abs(p[0]) == kBox.high.x; });
  });
  return cells;
}

class AgainstCgal : public testing::TestWithParam<PointSet> {};

// In general position the triangulations are equal. Cospherical ties may be cut in another way, but every
// ball stays empty and the box stays full.
TEST_P(AgainstCgal, IsADelaunayTriangulationOfTheSamePoints) {
  Triangulator ours(kBox);
  for (const Point& p : shuffled(GetParam().make(), 1)) ours.insert(p);
  Reference reference;
  for (VertexId v = 0; v < ours.mesh.vertex_bound(); ++v) {
    const Vertex& vertex = ours.mesh.vertex(v);
    if (vertex.kind != VertexKind::kUnused) {
      reference.insert({vertex.point.x, vertex.point.y, vertex.point.z});
    }
  }
  const auto cells = ours.cells();
  const auto expected = reference_cells(reference);
  EXPECT_NEAR(volume(cells), 8000, 1e-8);
  for (const auto& c : cells) {
    if (!std::binary_search(expected.begin(), expected.end(), c)) {
      EXPECT_TRUE(is_empty_ball(c, reference));
    }
  }
  // Corners of one box face are cocircular. Away from them, general position determines the triangulation.
  if (std::string(GetParam().name) == "random" || std::string(GetParam().name) == "clustered") {
    EXPECT_TRUE(away_from_corners(cells) == away_from_corners(expected));
  }
}

INSTANTIATE_TEST_SUITE_P(PointSets, AgainstCgal, testing::ValuesIn(point_sets()),
                         [](const auto& point_set) { return std::string(point_set.param.name); });

}  // namespace
}  // namespace podm::test
