#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "claims/check_fidelity_facets.h"
#include "claims/check_fidelity_isosurface.h"
#include "claims/claims.h"
#include "image/smoothing.h"
#include "meshed_voxels.h"

namespace podm::verify {
namespace {

ClaimResult fidelity_of(const Mesh& mesh, const Image& image, double bound = 1, int threads = 2) {
  Options options;
  options.threads = threads;
  options.fidelity_bound_voxels = bound;
  return check_fidelity(mesh, mapped_adjacency(mesh), image, options);
}

double number(const ClaimResult& result, const char* way, const char* what) {
  return result.details().at(way).at(what).get<double>();
}

// The isosurface is the voxels' faces, except near edges, where it cuts the corners of a box.
TEST(Fidelity, TheBoxesOwnFacesAreNear) {
  for (const auto& affine : kAffines)
    for (const Space space : {Space::kRas, Space::kLps, Space::kVoxel}) {
      const Image image = make_image({13, 11, 9}, affine, two_boxes);
      const ClaimResult result = fidelity_of(kuhn_mesh(image, space), image);
      EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
      EXPECT_NEAR(number(result, "image_to_mesh", "max_mm"), 0, 1e-9);
      // The weight at a corner of a box is a product. It is 1/2 where each factor is the cube root of 1/2.
      const double corner = std::sqrt(3.0) * (std::cbrt(0.5) - 0.5);
      if (affine == kUnitAffine) {
        EXPECT_NEAR(number(result, "mesh_to_image", "max_voxels"), corner, 1e-3);
      }
      EXPECT_LT(number(result, "mesh_to_image", "max_voxels"), std::sqrt(3.0) / 2);
    }
}

TEST(Fidelity, AShiftIsMeasuredInMillimetresAndVoxels) {
  for (const auto& affine : {kAnisotropic, kMirrored}) {
    const Image image = make_image({13, 11, 9}, affine, two_boxes);
    const Mesh mesh = kuhn_mesh(image);
    const std::array<double, 3> spacing{0.5, 0.8, 2.5};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Point by{};
      by[axis] = 2.5;
      const ClaimResult result = fidelity_of(moved(mesh, image, by), image);
      EXPECT_EQ(result.verdict, Verdict::kFail);
      // A point shifted along its normal by 2.5 voxels is at least as far from the faces that it leaves,
      // unless another face is nearer in mm.
      EXPECT_LE(number(result, "image_to_mesh", "max_mm"), 2.5 * spacing[axis] + 1e-9);
      EXPECT_GE(number(result, "image_to_mesh", "max_mm"), 0.99 * std::min(2.5 * spacing[axis], 0.5 * 1.5));
      EXPECT_FALSE(result.bad_cells.empty());
    }
  }
}

TEST(Fidelity, TheBoundDecides) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_boxes);
  const Mesh mesh = moved(kuhn_mesh(image), image, {1.2, 0, 0});
  EXPECT_EQ(fidelity_of(mesh, image, 1.3).verdict, Verdict::kPass);
  EXPECT_EQ(fidelity_of(mesh, image, 0.6).verdict, Verdict::kFail);
}

TEST(Fidelity, TwiceTheSamplingDistanceIsNearEnough) {
  for (const auto& affine : kAffines) {
    const Image image = make_image({13, 11, 9}, affine, two_boxes);
    Options options;
    options.threads = 1;
    options.fidelity_bound_voxels = 0.01;
    const auto result_for = [&](double delta_mm) {
      options.delta_mm = delta_mm;
      const Mesh mesh = kuhn_mesh(image);
      return check_fidelity(mesh, mapped_adjacency(mesh), image, options);
    };
    const double furthest_mm = number(result_for(1e-3), "mesh_to_image", "max_mm");
    EXPECT_EQ(result_for(0.49 * furthest_mm).verdict, Verdict::kFail);
    EXPECT_EQ(result_for(0.51 * furthest_mm).verdict, Verdict::kPass);
  }
}

TEST(Fidelity, AWrongSpaceFails) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_boxes);
  Mesh mesh = kuhn_mesh(image, Space::kLps);
  mesh.space = Space::kRas;
  EXPECT_EQ(fidelity_of(mesh, image).verdict, Verdict::kFail);
}

TEST(Fidelity, ALostStructureIsReportedAtItsDistance) {
  const auto with_speck = [](int i, int j, int k) {
    return i == 12 && j == 4 && k == 4 ? 9U : two_boxes(i, j, k);
  };
  const Image image = make_image({14, 11, 9}, kUnitAffine, with_speck),
              without = make_image({14, 11, 9}, kUnitAffine, two_boxes);
  const ClaimResult result = fidelity_of(kuhn_mesh(without), image);
  EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;  // 6 of 250 faces
  EXPECT_NEAR(number(result, "image_to_mesh", "max_mm"), 12.5 - 9.5, 1e-9);
}

TEST(Fidelity, LabelsAreComparedWithTheirOwnBoundary) {
  // The same outer surface; the wall between the labels is three voxels off.
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_boxes);
  const Image other = make_image({13, 11, 9}, kUnitAffine, [](int i, int j, int k) {
    const std::uint32_t label = two_boxes(i, j, k);
    return label == 0 ? 0U : i < 9 ? 3U : 7U;
  });
  const ClaimResult result = fidelity_of(kuhn_mesh(other), image);
  for (const auto& row : result.details()["labels"]) {
    // Label 3 lost its part beyond the wall; label 7 came nearer to the end of the box, one voxel away.
    EXPECT_NEAR(row["mesh_to_image"]["max_mm"].get<double>(), row["label"] == 3 ? 3 : 1, 0.3);
    EXPECT_NEAR(row["image_to_mesh"]["max_mm"].get<double>(), row["label"] == 3 ? 1.5 : 3, 1e-9);
  }
}

TEST(Fidelity, WithoutCellsLabelsOrInterfaceItIsNotRun) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_boxes);
  Mesh mesh = kuhn_mesh(image);
  EXPECT_EQ(fidelity_of({}, image).verdict, Verdict::kNotRun);
  EXPECT_EQ(fidelity_of(mesh, make_image({3, 3, 3}, kUnitAffine, [](int, int, int) { return 0U; })).verdict,
            Verdict::kNotRun);
  mesh.cell_labels.clear();
  EXPECT_EQ(fidelity_of(mesh, image).verdict, Verdict::kNotRun);
}

// Moves the vertices of the mesh's interface onto the image's.
Mesh on_interface(Mesh mesh, const Image& image) {
  const ImageFrame frame(image, mesh.space);
  const LabelFunction function(image);
  const Midpoints midpoints(image, frame, function);
  const IsosurfaceDistance distance(image, frame, midpoints, function);
  const InterfaceFacets facets(mesh, mapped_adjacency(mesh), frame, 1);
  std::uint32_t hint = 0;
  for (const InterfaceFacet& facet : facets.all())
    for (const VertexId v : facet.vertices)
      mesh.vertices[v] = frame.voxels_to_mesh(
          frame.world_to_voxels(distance.nearest(frame.to_world(mesh.vertices[v]), hint).point));
  return mesh;
}

TEST(Fidelity, OfASmoothedImageIsToItsSmoothInterface) {
  for (const auto& affine : {kUnitAffine, kAnisotropic}) {
    const Image stairs = make_image({13, 11, 9}, affine, two_balls);
    Image round = stairs;
    round.smoothing =
        smooth(stairs, *std::min_element(stairs.spacing.begin(), stairs.spacing.end()) * 1.5, 2);
    const Mesh mesh = on_interface(fine_mesh(round), round);
    const ClaimResult by_round = fidelity_of(mesh, round), by_stairs = fidelity_of(mesh, stairs);
    EXPECT_EQ(by_round.verdict, Verdict::kPass) << by_round.reason;
    EXPECT_LT(number(by_round, "mesh_to_image", "mean_mm"), number(by_stairs, "mesh_to_image", "mean_mm"));
    // At most a diagonal of the voxels that the mesh is made of.
    EXPECT_LT(number(by_round, "mesh_to_image", "max_voxels"), std::sqrt(3.0) / 3);
    // The report about the image before smoothing equals the report for that image alone.
    EXPECT_EQ(by_round.details().at("mesh_to_voxels"), by_stairs.details().at("mesh_to_image"));
    EXPECT_FALSE(by_stairs.details().contains("mesh_to_voxels"));
  }
}

TEST(Fidelity, ThreadsDoNotMatter) {
  const Image image = make_image({13, 11, 9}, kSheared, two_balls);
  const Mesh mesh = moved(kuhn_mesh(image), image, {0.4, 0.3, 0.2});
  const ClaimResult one = fidelity_of(mesh, image, 1, 1), three = fidelity_of(mesh, image, 1, 3);
  EXPECT_EQ(one.num_violations, three.num_violations);
  for (const char* way : {"mesh_to_image", "image_to_mesh"})
    for (const char* what : {"max_mm", "p95_voxels"})
      EXPECT_DOUBLE_EQ(number(one, way, what), number(three, way, what));
}

// The brute force takes the nearest of the places where the label changes on the lines of a fine grid.
TEST(IsosurfaceDistance, IsNeverBelowTheTrueOneAndMostlyNear) {
  constexpr int kFine = 20;
  for (const auto& [affine, width_mm] :
       {std::pair{kUnitAffine, 0.0}, {kAnisotropic, 0.0}, {kUnitAffine, 1.5}}) {
    Image image = make_image({9, 9, 9}, affine, [](int i, int j, int k) {
      return (i - 4) * (i - 4) + (j - 4) * (j - 4) + (k - 4) * (k - 4) <= 8 ? 1U : 0U;
    });
    if (width_mm > 0) image.smoothing = smooth(image, width_mm, 1);
    const ImageFrame frame(image, Space::kRas);
    const LabelFunction label(image);
    const Midpoints midpoints(image, frame, label);
    const IsosurfaceDistance distance(image, frame, midpoints, label);
    const double grid = std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]) / kFine;  // mm
    const double longest = *std::max_element(image.spacing.begin(), image.spacing.end());
    std::vector<Point> surface;
    for (int k = 0; k < 8 * kFine; ++k)
      for (int j = 0; j < 8 * kFine; ++j)
        for (int i = 0; i < 8 * kFine; ++i) {
          const Point u{i / double{kFine}, j / double{kFine}, k / double{kFine}};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            Point v = u;
            v[axis] += 1.0 / kFine;
            if (label.label_at(u) == label.label_at(v)) continue;
            v[axis] -= 0.5 / kFine;
            surface.push_back(frame.voxels_to_world(v));
          }
        }
    std::mt19937 random(1);
    std::uniform_real_distribution<double> anywhere(0, 8);
    std::uint32_t hint = kNone;
    std::vector<double> excess;
    for (int trial = 0; trial < 500; ++trial) {
      const Point p = frame.voxels_to_world({anywhere(random), anywhere(random), anywhere(random)});
      double squared = 1e300;
      for (const Point& q : surface) squared = std::min(squared, squared_distance(p, q));
      excess.push_back(std::sqrt(distance.nearest(p, hint).squared) - std::sqrt(squared));
    }
    std::sort(excess.begin(), excess.end());
    EXPECT_GE(excess.front(), -grid);
    EXPECT_LE(excess[excess.size() * 19 / 20], 0.1 * longest);
    EXPECT_LE(excess.back(), 0.25 * longest);
  }
}

TEST(NearestTree, FindsTheNearestTriangle) {
  const Image image = make_image({13, 11, 9}, kSheared, two_balls);
  const Mesh mesh = kuhn_mesh(image);
  const ImageFrame frame(image, Space::kRas);
  const InterfaceFacets facets(mesh, mapped_adjacency(mesh), frame, 1);
  std::vector<std::uint32_t> ids(facets.all().size());
  for (std::uint32_t i = 0; i < ids.size(); ++i) ids[i] = i;
  const NearestTree<InterfaceFacets> tree(facets, ids);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> anywhere(-5, 15);
  for (int trial = 0; trial < 300; ++trial) {
    const Point p = frame.voxels_to_world({anywhere(random), anywhere(random), anywhere(random)});
    double squared = 1e300;
    for (const std::uint32_t i : ids) {
      squared = std::min(squared, squared_distance(p, facets.closest(i, p)));
      // No point of the triangle is nearer than the closest one.
      facets.sample(i, [&](const Point& q, double) {
        ASSERT_GE(squared_distance(p, q), squared_distance(p, facets.closest(i, p)) * (1 - 1e-12));
      });
    }
    Nearest nearest;
    tree.improve(p, nearest);
    EXPECT_EQ(nearest.squared, squared);
  }
}

TEST(InterfaceFacets, SharesSumToOneAndNeighboursAreNear) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_boxes);
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 9}};
  mesh.cells = {{0, 1, 2, 3}};
  mesh.cell_labels = {3};
  const ImageFrame frame(image, Space::kRas);
  const InterfaceFacets facets(mesh, mapped_adjacency(mesh), frame, 1);
  ASSERT_EQ(facets.all().size(), 4U);
  double area = 0;
  for (std::uint32_t f = 0; f < 4; ++f) {
    double shares = 0;
    std::vector<Point> points;
    facets.sample(f, [&](const Point& p, double share) {
      shares += share;
      points.push_back(frame.world_to_voxels(p));
    });
    EXPECT_NEAR(shares, 1, 1e-12);
    area += facets.area(f);
    for (std::size_t i = 1; i < points.size(); ++i) {
      double nearest = 1e300;
      for (std::size_t j = 0; j < points.size(); ++j)
        if (i != j) nearest = std::min(nearest, squared_distance(points[i], points[j]));
      EXPECT_LT(nearest, 0.25);
    }
  }
  EXPECT_NEAR(area, 6 + 18 + 13.5 + 0.5 * std::sqrt(27.0 * 27 + 36 * 36 + 12 * 12), 1e-9);
}

}  // namespace
}  // namespace podm::verify
