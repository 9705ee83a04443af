#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

ClaimResult radius_edge_of(const Mesh& mesh, double bound) {
  Options options = two_threads();
  options.radius_edge_bound = bound;
  return check_radius_edge(mesh, find_adjacency(mesh, 2), options);
}

TEST(RadiusEdge, IsStrictAtTheBound) {
  for (const double scale : {1.0, 3.0, 0x1p-40, 0x1p300}) {  // ratio 3/2 exactly
    const Mesh mesh = corner(scale, 2 * scale, 2 * scale);
    EXPECT_EQ(radius_edge_of(mesh, 1.5).verdict, Verdict::kFail);
    EXPECT_EQ(radius_edge_of(mesh, std::nextafter(1.5, 2)).verdict, Verdict::kPass);
    EXPECT_EQ(radius_edge_of(mesh, std::nextafter(1.5, 1)).verdict, Verdict::kFail);
  }
}

TEST(RadiusEdge, TakesTheBoundAsTyped) {
  // Four points of the sphere of radius 13, the first two at distance 10, the others further apart: ratio
  // 13/10. The double next to 1.3 is above it.
  const Mesh mesh = mesh_of({{-12, -5, 0}, {-12, 5, 0}, {-5, 0, 12}, {-4, -12, -3}}, {{0, 1, 2, 3}});
  EXPECT_EQ(radius_edge_of(mesh, 1.3).verdict, Verdict::kFail);
  EXPECT_EQ(radius_edge_of(mesh, std::nextafter(1.3, 2)).verdict, Verdict::kPass);
}

TEST(RadiusEdge, DecidesAnUlp) {
  // The fourth vertex moves past the point where the ratio is the bound.
  const auto ratio_below = [](double c) {
    return radius_edge_of(corner(1, 2, c), 1.5).verdict == Verdict::kPass;
  };
  EXPECT_TRUE(ratio_below(std::nextafter(2, 1)));
  EXPECT_FALSE(ratio_below(2));
  EXPECT_FALSE(ratio_below(std::nextafter(2, 3)));
}

TEST(RadiusEdge, DoesNotDependOnOrientationOrOrder) {
  for (const double bound : {1.5, 1.6}) {
    Mesh mesh = corner(1, 2, 2);
    const Verdict expected = radius_edge_of(mesh, bound).verdict;
    std::array<VertexId, 4> order{0, 1, 2, 3};
    do {
      mesh.cells[0] = order;
      EXPECT_EQ(radius_edge_of(mesh, bound).verdict, expected);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(RadiusEdge, RejectsFlatCellsUnderAnyBound) {
  const std::vector<Mesh> flat{two_cells({0.5, 0.5, 0}),
                               mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2, 3}}),
                               mesh_of({{1, 1, 1}}, {{0, 0, 0, 0}})};
  for (const Mesh& mesh : flat) {
    const ClaimResult result = radius_edge_of(mesh, 1e6);
    EXPECT_EQ(result.num_violations, 1);
    EXPECT_TRUE(std::isinf(result.worst[0].value));
  }
}

TEST(RadiusEdge, NamesTheWorstAndOnAPassTheClosest) {
  Mesh mesh = joined(corner(1, 1, 1), corner(1, 2, 2));
  ClaimResult result = radius_edge_of(mesh, 1.93);
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_TRUE(result.bad_cells.empty());
  ASSERT_EQ(result.worst.size(), 2);
  EXPECT_EQ(result.worst[0].cells, std::vector<GlobalId>{1});
  EXPECT_NEAR(result.worst[0].value, 1.5, 1e-12);
  mesh = joined(mesh, corner(1, 9, 9));
  result = radius_edge_of(mesh, 1.93);
  ASSERT_EQ(result.worst.size(), 1);
  EXPECT_EQ(result.bad_cells, std::vector<GlobalId>{2});
}

TEST(RadiusEdge, HistogramsHoldEveryCellAndDihedralAngle) {
  const Mesh mesh = kuhn_cubes(2);
  const ClaimResult result = radius_edge_of(mesh, 1.93);
  const auto sum = [](const Histogram& h) {
    return std::accumulate(h.counts.begin(), h.counts.end(), std::uint64_t{0});
  };
  EXPECT_EQ(sum(result.histograms[0]), mesh.cells.size());
  EXPECT_EQ(sum(result.histograms[1]), 6 * mesh.cells.size());
  EXPECT_EQ(result.histograms[1].counts.size(), 180u) << "a bin a degree";
  EXPECT_NEAR(result.histograms[1].minimum, 45, 1e-9);
  EXPECT_NEAR(result.histograms[1].maximum, 90, 1e-9);
}

}  // namespace
}  // namespace podm::verify
