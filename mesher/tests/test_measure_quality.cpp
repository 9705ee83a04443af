// Measures of a mesh equal their definitions, cell by cell, and are bitwise equal on any number of threads.
#include "run/measure_quality.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "geometry/point.h"
#include "geometry/predicates.h"
#include "tests/images.h"

namespace podm::test {
namespace {

using Corners = std::array<Point, 4>;

double length(const Vector& v) { return std::sqrt(squared_length(v)); }
double six_volumes(const Corners& p) { return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]); }
double angle_deg(const Vector& u, const Vector& v) {
  return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

double circumradius(const Corners& p) {
  const Vector a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const Vector sum =
      squared_length(a) * cross(b, c) + squared_length(b) * cross(c, a) + squared_length(c) * cross(a, b);
  return length(sum) / (2 * std::abs(six_volumes(p)));
}

// Returns the angle between the planes through the edge's ends and either of the other two corners.
double dihedral_deg(const Corners& p, unsigned i, unsigned j, unsigned k, unsigned l) {
  const Vector edge = p[j] - p[i];
  return angle_deg(cross(edge, p[k] - p[i]), cross(edge, p[l] - p[i]));
}

struct Extremes {
  double low = 1e300, high = -1e300;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

// Random cells and facets of labels 1 to 3; about every second cell is inverted. Label 4 has only voxels.
class MeasureQuality : public testing::Test {
 protected:
  MeasureQuality() {
    mesh_.labels = image_.labels;
    for (int i = 0; i < 300; ++i) mesh_.vertices.push_back({uniform(), uniform(), uniform()});
    for (int i = 0; i < 20000; ++i) {
      mesh_.cells.push_back(draw<4>());
      mesh_.cell_labels.push_back(static_cast<LabelIndex>(1 + random_() % 3));
    }
    for (int i = 0; i < 3000; ++i) mesh_.facets.push_back(draw<3>());
  }

  double uniform() { return std::uniform_real_distribution(0.0, 9.0)(random_); }
  // Returns distinct vertices.
  template <std::size_t N>
  std::array<std::uint32_t, N> draw() {
    std::set<std::uint32_t> drawn;
    while (drawn.size() < N) drawn.insert(static_cast<std::uint32_t>(random_() % mesh_.vertices.size()));
    std::array<std::uint32_t, N> vertices{};
    std::copy(drawn.begin(), drawn.end(), vertices.begin());
    if (random_() % 2 == 0) std::swap(vertices[0], vertices[1]);
    return vertices;
  }
  Point point(std::uint32_t v) const {
    return {mesh_.vertices[v][0], mesh_.vertices[v][1], mesh_.vertices[v][2]};
  }
  Corners corners(std::size_t c) const {
    const auto& cell = mesh_.cells[c];
    return {point(cell[0]), point(cell[1]), point(cell[2]), point(cell[3])};
  }
  MeshingReport measure(int threads) const {
    MeshingReport report;
    measure_quality(mesh_, image_, SizeField(radii_), threads, report);
    return report;
  }
  static auto numbers_of(const MeshingReport& report) {
    const Quality& q = report.quality;
    const Guarantees& g = report.guarantees;
    return std::tuple(q.max_radius_edge, q.min_facet_angle_deg, q.max_facet_angle_deg, q.min_dihedral_deg,
                      q.max_dihedral_deg, q.max_radius_mm, q.shortest_edge_mm, g.radius_edge, g.facet_angle,
                      g.radius, g.orientation, g.missing_labels, report.cells_of_label,
                      report.volume_of_label_mm3);
  }

  std::mt19937_64 random_{5};
  LabelImage image_ = make_image({16, 16, 16}, {1, 1, 1}, 4, [](int i, int, int) { return 1 + i / 4; });
  std::vector<double> radii_{10, 5, 6, 7, 8};
  TetMesh mesh_;
};

TEST_F(MeasureQuality, IsWhatTheDefinitionsSay) {
  Extremes edge, dihedral, radius, ratio, facet_angle;
  Guarantees expected;
  std::map<std::uint32_t, std::uint64_t> cells{{10, 0}, {20, 0}, {30, 0}, {40, 0}};
  std::map<std::uint32_t, double> volume;
  for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
    const Corners p = corners(c);
    if (six_volumes(p) <= 0) {
      ++expected.orientation;
      continue;
    }
    Extremes own_edge;
    constexpr unsigned kEdges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                       {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
    for (const auto& [i, j, k, l] : kEdges) {
      own_edge.add(length(p[j] - p[i]));
      dihedral.add(dihedral_deg(p, i, j, k, l));
    }
    const double own_radius = circumradius(p), own_ratio = own_radius / own_edge.low;
    edge.add(own_edge.low);
    radius.add(own_radius);
    ratio.add(own_ratio);
    const LabelIndex label = mesh_.cell_labels[c];
    expected.radius_edge += own_ratio >= kRadiusEdgeBound;
    expected.radius += own_radius > radii_[label];
    ++cells[10u * label];
    volume[10u * label] += six_volumes(p) / 6;
  }
  for (const auto& [i, j, k] : mesh_.facets) {
    const Point a = point(i), b = point(j), c = point(k);
    Extremes own;
    for (const double angle : {angle_deg(b - a, c - a), angle_deg(c - b, a - b), angle_deg(a - c, b - c)})
      own.add(angle);
    facet_angle.add(own.low);
    facet_angle.add(own.high);
    expected.facet_angle += own.low <= kFacetAngleBound;
  }

  const MeshingReport report = measure(2);
  const Quality& quality = report.quality;
  EXPECT_DOUBLE_EQ(quality.shortest_edge_mm, edge.low);
  EXPECT_NEAR(quality.min_dihedral_deg, dihedral.low, 1e-9);
  EXPECT_NEAR(quality.max_dihedral_deg, dihedral.high, 1e-9);
  EXPECT_NEAR(quality.max_radius_mm / radius.high, 1, 1e-6);
  EXPECT_NEAR(quality.max_radius_edge / ratio.high, 1, 1e-6);
  EXPECT_NEAR(quality.min_facet_angle_deg, facet_angle.low, 1e-9);
  EXPECT_NEAR(quality.max_facet_angle_deg, facet_angle.high, 1e-9);
  EXPECT_EQ(report.guarantees.orientation, expected.orientation);
  EXPECT_EQ(report.guarantees.radius_edge, expected.radius_edge);
  EXPECT_EQ(report.guarantees.radius, expected.radius);
  EXPECT_EQ(report.guarantees.facet_angle, expected.facet_angle);
  EXPECT_EQ(report.guarantees.missing_labels, 1u) << "label 4 has 1024 voxels and no cell";
  EXPECT_EQ(report.cells_of_label, cells);
  for (const std::uint32_t label : {10u, 20u, 30u})
    EXPECT_NEAR(report.volume_of_label_mm3.at(label) / volume[label], 1, 1e-12);
}

TEST_F(MeasureQuality, IsTheSameToTheBitOnAnyNumberOfThreads) {
  const auto one = numbers_of(measure(1));
  for (const int threads : {2, 3, 8, 0})
    for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(numbers_of(measure(threads)), one) << threads;
}

// Grid points on a plane that doubles do not represent exactly: the sign of a volume is that of the rounded
// points.
TEST_F(MeasureQuality, SeesExactlyWhichFlatCellsArePositive) {
  for (auto& [x, y, z] : mesh_.vertices) {
    x = static_cast<double>(random_() % 8) / 10;
    y = static_cast<double>(random_() % 8) / 10;
    z = 0.3 * x + 0.7 * y;
  }
  std::uint64_t negative = 0, positive = 0;
  for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
    const Corners p = corners(c);
    (orientation(p[0], p[1], p[2], p[3]) <= 0 ? negative : positive) += 1;
  }
  EXPECT_GT(positive, 100u);
  EXPECT_EQ(measure(2).guarantees.orientation, negative);
}

TEST_F(MeasureQuality, OfFewCellsOrNone) {
  for (const std::size_t cells : {std::size_t{0}, std::size_t{1}, std::size_t{50}}) {
    mesh_.cells.resize(cells);
    mesh_.facets.resize(cells);
    const MeshingReport report = measure(3);
    std::uint64_t counted = report.guarantees.orientation;
    for (const auto& [label, n] : report.cells_of_label) counted += n;
    EXPECT_EQ(counted, cells);
    if (counted > report.guarantees.orientation) {
      EXPECT_LT(report.quality.min_dihedral_deg, report.quality.max_dihedral_deg);
    } else {
      EXPECT_EQ(report.quality.min_dihedral_deg, 180);
      EXPECT_EQ(report.quality.max_dihedral_deg, 0);
    }
    EXPECT_EQ(report.quality.shortest_edge_mm > 0, counted > report.guarantees.orientation);
  }
}

// Tests all choices of equal vertices.
TEST_F(MeasureQuality, FacetsWithoutAreaHaveAnAngleOfZero) {
  const auto [a, b, c] = draw<3>();
  for (const auto& facet : {std::array{a, a, b}, {a, b, a}, {b, a, a}, {c, c, c}}) {
    SCOPED_TRACE(testing::PrintToString(facet));
    mesh_.facets.assign({{a, b, c}, facet});
    const MeshingReport report = measure(1);
    EXPECT_EQ(report.quality.min_facet_angle_deg, 0);
    EXPECT_GE(report.guarantees.facet_angle, 1u);
  }
}

}  // namespace
}  // namespace podm::test
