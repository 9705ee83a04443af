#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

ClaimResult dihedral_of(const Mesh& mesh, std::optional<double> least, std::optional<double> largest) {
  Options options = two_threads();
  options.min_dihedral_deg = least;
  options.max_dihedral_deg = largest;
  return check_dihedral(mesh, options);
}

// Returns a cell with two facets that meet at this angle; its other angles are moderate.
Mesh wedge(double degrees) {
  const double t = degrees * std::numbers::pi / 180;
  return mesh_of({{-0.5, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, {0, std::cos(t), std::sin(t)}}, {{0, 1, 2, 3}});
}

TEST(Dihedral, IsNotRunWithoutABoundOrAPromise) {
  const ClaimResult result = dihedral_of(corner(1, 1, 1), std::nullopt, std::nullopt);
  EXPECT_EQ(result.verdict, Verdict::kNotRun);
  EXPECT_FALSE(result.reason.empty());
}

TEST(Dihedral, UsesThePromiseOfTheFileUnlessOptionsGiveBounds) {
  Mesh mesh = wedge(7);
  mesh.promised_dihedral_deg = {8, 165};
  EXPECT_EQ(dihedral_of(mesh, std::nullopt, std::nullopt).verdict, Verdict::kFail);
  EXPECT_EQ(dihedral_of(mesh, 6, std::nullopt).verdict, Verdict::kPass);
  mesh.promised_dihedral_deg = {6, 165};
  EXPECT_EQ(dihedral_of(mesh, std::nullopt, std::nullopt).verdict, Verdict::kPass);
}

TEST(Dihedral, AllowsEqualityAndNotAnUlpBeyond) {
  const Mesh right = corner(1, 1, 1);  // right angles at the origin: least and largest angle differ
  EXPECT_EQ(dihedral_of(right, std::nullopt, 90).verdict, Verdict::kPass);
  Mesh obtuse = right;
  obtuse.vertices[2] = {-0x1p-52, 1, 0};
  EXPECT_EQ(dihedral_of(obtuse, std::nullopt, 90).verdict, Verdict::kFail);
  const Mesh half = mesh_of({{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 1}}, {{0, 1, 2, 3}});  // 45 degrees
  EXPECT_EQ(dihedral_of(half, 45, std::nullopt).verdict, Verdict::kPass);
  Mesh flatter = half;
  flatter.vertices[3] = {0, 1, std::nextafter(1, 0)};
  EXPECT_EQ(dihedral_of(flatter, 45, std::nullopt).verdict, Verdict::kFail);
}

TEST(Dihedral, JudgesEachEndByItself) {
  EXPECT_EQ(dihedral_of(wedge(7.99), 8, std::nullopt).verdict, Verdict::kFail);
  EXPECT_EQ(dihedral_of(wedge(8.01), 8, std::nullopt).verdict, Verdict::kPass);
  EXPECT_EQ(dihedral_of(wedge(165.01), std::nullopt, 165).verdict, Verdict::kFail);
  EXPECT_EQ(dihedral_of(wedge(164.99), std::nullopt, 165).verdict, Verdict::kPass);
  EXPECT_EQ(dihedral_of(wedge(7.99), std::nullopt, 165).verdict, Verdict::kPass);
  EXPECT_EQ(dihedral_of(wedge(100.1), std::nullopt, 100.1 + 1e-9).verdict, Verdict::kPass);
  EXPECT_EQ(dihedral_of(wedge(100.1), std::nullopt, 100.1 - 1e-9).verdict, Verdict::kFail);
}

TEST(Dihedral, DoesNotDependOnOrientationOrOrder) {
  Mesh mesh = wedge(7.99);
  std::array<VertexId, 4> order{0, 1, 2, 3};
  do {
    mesh.cells = {order};
    EXPECT_EQ(dihedral_of(mesh, 8, 165).num_violations, 1);
    EXPECT_EQ(dihedral_of(mesh, 7.98, 165).num_violations, 0);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Dihedral, RejectsFlatCellsByEitherBound) {
  for (const Mesh& flat : {mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}),
                           mesh_of({{1, 1, 1}}, {{0, 0, 0, 0}})}) {
    EXPECT_EQ(dihedral_of(flat, 1e-9, std::nullopt).num_violations, 1);
    EXPECT_EQ(dihedral_of(flat, std::nullopt, 179.999).num_violations, 1);
  }
}

TEST(Dihedral, HistogramHasABinPerDegree) {
  for (const double degrees : {7.01, 7.99, 8.01, 164.99, 165.01, 179.9}) {
    const Histogram histogram = dihedral_of(wedge(degrees), 1, std::nullopt).histograms.at(0);
    ASSERT_EQ(histogram.counts.size(), 180u);
    EXPECT_GT(histogram.counts[static_cast<std::size_t>(degrees)], 0u) << degrees;
    EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::uint64_t{0}), 6u);
  }
}

TEST(Dihedral, NamesTheWorstAndOnAPassTheClosest) {
  const Mesh mesh = joined(wedge(60), joined(wedge(5), wedge(7)));
  for (const double least : {4.0, 8.0}) {
    const ClaimResult result = dihedral_of(mesh, least, std::nullopt);
    ASSERT_FALSE(result.worst.empty());
    EXPECT_EQ(result.worst[0].cells, std::vector<GlobalId>{1});
    EXPECT_NEAR(result.worst[0].value, 5, 1e-9);
  }
  EXPECT_EQ(dihedral_of(mesh, 8, 165).bad_cells, (std::vector<GlobalId>{1, 2}));
}

}  // namespace
}  // namespace podm::verify
