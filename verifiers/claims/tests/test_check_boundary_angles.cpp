#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

ClaimResult angles_of(const Mesh& mesh, double bound) {
  Options options = two_threads();
  options.angle_bound_deg = bound;
  return check_boundary_angles(mesh, find_adjacency(mesh, 2), options);
}

TEST(BoundaryAngles, DistinguishesEquality) {
  const Mesh cubes = kuhn_cubes(1);  // all boundary facets have angles of 45, 45 and 90 degrees
  const ClaimResult equal = angles_of(cubes, 45);
  EXPECT_EQ(equal.verdict, Verdict::kFail);
  EXPECT_EQ(equal.details()["facets_equal_to_bound"], 12);
  EXPECT_TRUE(names(equal, "angles exceed the bound (equal to it)"));
  EXPECT_EQ(angles_of(cubes, std::nextafter(45, 0)).verdict, Verdict::kPass);
  const ClaimResult over = angles_of(cubes, std::nextafter(45, 90));
  EXPECT_EQ(over.num_violations, 12);
  EXPECT_EQ(over.details()["facets_equal_to_bound"], 0);
}

TEST(BoundaryAngles, DecidesThirtyDegreesExactly) {
  // The facet has angles of 30, 60 and 90 degrees; a larger z opens the first.
  const Point u{2, 2, 0}, v{1, 2, 1};
  ASSERT_EQ(4 * dot(u, v) * dot(u, v), 3 * dot(u, u) * dot(v, v));
  const auto with_z = [&](double z) {
    return angles_of(mesh_of({{0, 0, 0}, u, {v[0], v[1], z}, {3, -1, -1}}, {{0, 1, 2, 3}}), 30);
  };
  EXPECT_EQ(with_z(1).details()["facets_equal_to_bound"], 1);
  EXPECT_EQ(with_z(std::nextafter(1, 2)).details()["facets_equal_to_bound"], 0);
  EXPECT_EQ(with_z(std::nextafter(1, 2)).num_violations, with_z(1).num_violations - 1);
  EXPECT_EQ(with_z(std::nextafter(1, 0)).num_violations, with_z(1).num_violations);
}

// A facet has an angle of `degrees`; the rest of the cell is well shaped.
TEST(BoundaryAngles, HoldsEveryBound) {
  for (const double degrees : {3.0, 20.0, 29.999, 30.001, 37.5, 59.0}) {
    const double t = degrees * std::numbers::pi / 180;
    const Mesh mesh =
        mesh_of({{0, 0, 0}, {1, 0, 0}, {std::cos(t), std::sin(t), 0}, {0.5, 0.2, 1}}, {{0, 1, 2, 3}});
    const double least = angles_of(mesh, 1).histograms[0].minimum;
    EXPECT_LE(least, degrees + 1e-9);
    EXPECT_EQ(angles_of(mesh, least - 1e-9).verdict, Verdict::kPass);
    EXPECT_EQ(angles_of(mesh, least + 1e-9).verdict, Verdict::kFail);
  }
}

TEST(BoundaryAngles, NoFacetExceedsSixtyDegrees) {
  const Mesh regular = mesh_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2, 3}});
  EXPECT_EQ(angles_of(regular, 60).details()["facets_equal_to_bound"], 4);
  for (const double bound : {60.5, 90.0, 100.0, 150.0, 179.0})
    EXPECT_EQ(angles_of(regular, bound).num_violations, 4);
  EXPECT_EQ(angles_of(regular, 59.999).verdict, Verdict::kPass);
}

TEST(BoundaryAngles, LooksAtInterfacesButNotInside) {
  // Two cells on a flat facet; all others are well shaped.
  const double flat_angle = std::atan(0.1) * 180 / std::numbers::pi;
  Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0.5, 0.05, 0}, {0.5, 0.5, 1}, {0.5, 0.5, -1}},
                      {{0, 1, 2, 3}, {0, 2, 1, 4}});
  EXPECT_GT(angles_of(mesh, 1).histograms[0].minimum, 2 * flat_angle);
  EXPECT_EQ(angles_of(mesh, 1).num_checked, 6);
  mesh.cell_labels = {1, 1};
  EXPECT_EQ(angles_of(mesh, 1).num_checked, 6);
  EXPECT_GT(angles_of(mesh, 1).histograms[0].minimum, 2 * flat_angle);
  mesh.cell_labels = {1, 2};
  EXPECT_EQ(angles_of(mesh, 1).num_checked, 7);
  EXPECT_NEAR(angles_of(mesh, 1).histograms[0].minimum, flat_angle, 1e-9);
  mesh.cells.resize(1);
  mesh.cell_labels.resize(1);
  EXPECT_EQ(angles_of(mesh, 1).num_checked, 4);
  EXPECT_NEAR(angles_of(mesh, 1).histograms[0].minimum, flat_angle, 1e-9);
}

TEST(BoundaryAngles, RejectsFlatFacets) {
  const Mesh line = mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 2, 3}});
  EXPECT_EQ(angles_of(line, 1).num_violations, 1);
  EXPECT_EQ(angles_of(mesh_of({{1, 1, 1}}, {{0, 0, 0, 0}}), 1).verdict, Verdict::kFail);
}

TEST(BoundaryAngles, NamesTheSmallestFirst) {
  const Mesh mesh = joined(corner(1, 1, 1), corner(1, 3, 3));
  for (const double bound : {1.0, 44.0}) {
    const ClaimResult result = angles_of(mesh, bound);
    ASSERT_FALSE(result.worst.empty());
    EXPECT_EQ(result.worst[0].cells, std::vector<GlobalId>{1});
    EXPECT_NEAR(result.worst[0].value, std::atan(1. / 3) * 180 / std::numbers::pi, 1e-9);
  }
}

}  // namespace
}  // namespace podm::verify
