// Checks dihedral angles against their definition by planes, and that the quality identifies the worse cell.
#include "geometry/dihedral.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "geometry/tetrahedron.h"

namespace podm::test {
namespace {

using Corners = std::array<Point, 4>;

DihedralExtremes extremes(const Corners& p) { return dihedral_extremes(p[0], p[1], p[2], p[3]); }

// Returns the angle at the edge ij between the planes through it and each of the other two corners.
double dihedral_at(const Corners& p, unsigned i, unsigned j) {
  unsigned k = 0;
  while (k == i || k == j) ++k;
  const unsigned l = 6 - i - j - k;
  const Vector edge = p[j] - p[i], u = cross(edge, p[k] - p[i]), v = cross(edge, p[l] - p[i]);
  return std::atan2(std::sqrt(squared_length(cross(u, v))), dot(u, v)) * kRadToDeg;
}

Corners random_positive_cell(std::mt19937_64& random, double flatness) {
  std::uniform_real_distribution coordinate(-1.0, 1.0);
  for (;;) {
    Corners p;
    for (Point& corner : p) corner = {coordinate(random), coordinate(random), flatness * coordinate(random)};
    if (extremes(p).determinant > 0) return p;
  }
}

// Returns a cell whose two facets at the x axis meet at this angle; the other angles are moderate.
Corners wedge(double degrees) {
  const double angle = degrees / kRadToDeg;
  return {{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, std::cos(angle), std::sin(angle)}}};
}

TEST(DihedralExtremes, AreThoseOfThePlanes) {
  std::mt19937_64 random(1);
  for (const double flatness : {1.0, 1e-2, 1e-4}) {
    for (int i = 0; i < 3000; ++i) {
      const Corners p = random_positive_cell(random, flatness);
      double least = 180, largest = 0;
      for (const auto& [v, w] : kEdgeVertices) {
        const double angle = dihedral_at(p, static_cast<unsigned>(v), static_cast<unsigned>(w));
        least = std::min(least, angle);
        largest = std::max(largest, angle);
      }
      ASSERT_NEAR(extremes(p).least_deg(), least, 1e-7);
      ASSERT_NEAR(extremes(p).largest_deg(), largest, 1e-7);
    }
  }
}

TEST(DihedralExtremes, OfAFlatCellAre0And180) {
  const Corners square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  EXPECT_EQ(extremes(square).least_deg(), 0);
  EXPECT_EQ(extremes(square).largest_deg(), 180);
}

TEST(DihedralExtremes, OfNoAngleAreTheWorst) {
  const DihedralExtremes of_point = extremes({{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}});
  EXPECT_EQ(of_point.least_deg(), 0);
  EXPECT_EQ(DihedralBounds(8, 165).quality(of_point), 0);
}

TEST(DihedralBounds, QualityIs1AtEitherBound) {
  const DihedralBounds bounds(8, 165);
  EXPECT_NEAR(bounds.quality(extremes(wedge(8))), 1, 1e-12);
  EXPECT_LT(bounds.quality(extremes(wedge(7.999))), 1);
  EXPECT_GT(bounds.quality(extremes(wedge(8.001))), 1);
  // A cell with an angle of 165 degrees whose small angles are larger than 8.
  const DihedralExtremes large{1, -1 / std::pow(std::tan(15 / kRadToDeg), 2), 1};
  EXPECT_NEAR(large.largest_deg(), 165, 1e-9);
  EXPECT_NEAR(bounds.quality(large), 1, 1e-12);
}

TEST(DihedralBounds, QualityRisesWithTheWorstAngle) {
  const DihedralBounds bounds(12, 160);
  double before = -1;
  for (double degrees = 0.01; degrees < 12; degrees += 0.37) {
    const double quality = bounds.quality(extremes(wedge(degrees)));
    EXPECT_GT(quality, before);
    before = quality;
  }
}

TEST(DihedralBounds, QualityOfATurnedCellIs0) {
  const Corners p = wedge(60);
  EXPECT_GT(DihedralBounds(8, 165).quality(extremes(p)), 1);
  EXPECT_EQ(DihedralBounds(8, 165).quality(extremes({p[1], p[0], p[2], p[3]})), 0);
}

}  // namespace
}  // namespace podm::test
