// Local sizes: with every algorithm no cell exceeds its bound, which an exhaustive search computes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/circumsphere.h"
#include "podm/mesh_image.h"
#include "podm/mesh_io.h"
#include "prediction/cost_model.h"
#include "sizing/make_size_grid.h"
#include "tests/fault_of.h"
#include "tests/images.h"

namespace podm {
namespace {

using test::ball;
using test::make_image;

/// Returns a volume of `n` voxels per axis over the box of the test images, which have 1 mm voxels, and a
/// little more.
SizeImage sizes_over(int n, int num_voxels, const std::function<double(const Point&)>& radius_at) {
  const double step = (num_voxels + 4.0) / (n - 1);
  SizeImage sizes{.path = "sizes.nii",
                  .size = {n, n, n},
                  .voxel_to_ras = {step, 0, 0, -9, 0, step, 0, 9, 0, 0, step, 1},
                  .radius_mm = {}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        sizes.radius_mm.push_back(static_cast<float>(radius_at({-9 + i * step, 9 + j * step, 1 + k * step})));
  return sizes;
}

/// Computes the bound at a point as the documentation of SizeImage defines it; 0: no bound.
double bound_by(const SizeImage& sizes, const Point& p) {
  const auto u = map(inverse(sizes.voxel_to_ras), std::array<double, 3>{p.x, p.y, p.z});
  double sum = 0, weights = 0;
  for (int k = 0, number = 0; k < sizes.size[2]; ++k)
    for (int j = 0; j < sizes.size[1]; ++j)
      for (int i = 0; i < sizes.size[0]; ++i, ++number) {
        const auto weight = [&](int at, std::size_t axis) {
          const double inside = std::clamp(u[axis], 0.0, sizes.size[axis] - 1.0);
          return std::fabs(u[axis] - inside) > 0.5 ? 0 : std::max(0.0, 1 - std::fabs(inside - at));
        };
        const double radius = sizes.radius_mm[static_cast<std::size_t>(number)];
        const double w = radius > 0 ? weight(i, 0) * weight(j, 1) * weight(k, 2) : 0;
        sum += w * radius;
        weights += w;
      }
  return weights > 0 ? sum / weights : 0;
}

struct Sphere {
  Point center;
  double radius;
};

std::vector<Sphere> spheres_of(const TetMesh& mesh) {
  std::vector<Sphere> spheres;
  for (const auto& cell : mesh.cells) {
    std::array<Point, 4> p;
    for (std::size_t v = 0; v < 4; ++v)
      p[v] = {mesh.vertices[cell[v]][0], mesh.vertices[cell[v]][1], mesh.vertices[cell[v]][2]};
    const Circumsphere sphere = circumsphere(p[0], p[1], p[2], p[3], 0);
    spheres.push_back({sphere.center, std::sqrt(sphere.squared_radius)});
  }
  return spheres;
}

std::size_t num_over(const TetMesh& mesh, const SizeImage& sizes, double factor = 1) {
  const auto spheres = spheres_of(mesh);
  return static_cast<std::size_t>(std::count_if(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
    const double bound = bound_by(sizes, sphere.center);
    return bound > 0 && sphere.radius > factor * bound;
  }));
}

MeshingOptions with(SizeImage sizes) {
  MeshingOptions options;
  options.sizes.image = std::make_shared<const SizeImage>(std::move(sizes));
  options.team.threads = 1;
  return options;
}

double ramp(const Point& p) { return 0.8 + 0.1 * (p.x + 9); }

TEST(SizesByPlace, BoundEveryCellByEveryAlgorithm) {
  const LabelImage image = ball(24, 9);
  const SizeImage sizes = sizes_over(8, 24, ramp);
  for (const Algorithm algorithm :
       {Algorithm::kPodm, Algorithm::kPodmHome, Algorithm::kPdr, Algorithm::kPdrPodm})
    for (const int threads : {1, 2}) {
      MeshingOptions options = with(sizes);
      options.algorithm = algorithm;
      options.team.threads = threads;
      options.team.oversubscribe = true;
      const MeshingResult result = mesh_image(image, options);
      EXPECT_TRUE(result.report.guarantees.all_met());
      EXPECT_GT(result.mesh.cells.size(), 1000);
      EXPECT_EQ(num_over(result.mesh, sizes), 0) << to_string(algorithm);
    }
}

TEST(SizesByPlace, BoundCellsWhereOptimisationAndR7ChangeThem) {
  const SizeImage sizes = sizes_over(8, 24, ramp);
  MeshingOptions options = with(sizes);
  options.min_dihedral_deg = 5;
  options.optimize.is_wanted = true;
  const MeshingResult result = mesh_image(ball(24, 9), options);
  EXPECT_TRUE(result.report.guarantees.all_met());
  EXPECT_EQ(num_over(result.mesh, sizes), 0);
}

TEST(SizesByPlace, BoundNothingWhereThereIsNone) {
  const SizeImage half = sizes_over(9, 24, [](const Point& p) { return p.x < 3 ? 0.9 : 0; });
  const MeshingResult result = mesh_image(ball(24, 9), with(half));
  EXPECT_EQ(num_over(result.mesh, half), 0);
  const auto spheres = spheres_of(result.mesh);
  EXPECT_TRUE(std::any_of(spheres.begin(), spheres.end(),
                          [](const Sphere& s) { return s.center.x > 8 && s.radius > 1.5; }));
}

TEST(SizesByPlace, MakeTheMeshOfARadiusWhereTheyAreConstant) {
  for (const auto& [name, make] : test::images()) {
    const LabelImage image = make();
    SizeImage sizes = sizes_over(5, 40, [](const Point&) { return 2; });
    sizes.voxel_to_ras = {300, 0, 0, -400, 0, 300, 0, -400, 0, 0, 300, -400};
    MeshingOptions by_radius;
    by_radius.sizes.radius_mm = 2;
    by_radius.team.threads = 1;
    MeshingResult a = mesh_image(image, with(sizes)), b = mesh_image(image, by_radius);
    EXPECT_EQ(a.report.delta_mm, b.report.delta_mm) << name;
    EXPECT_NEAR(static_cast<double>(a.mesh.cells.size()), static_cast<double>(b.mesh.cells.size()),
                0.03 * static_cast<double>(b.mesh.cells.size()))
        << name;
  }
}

TEST(SizesByPlace, AreScaledToATarget) {
  const SizeImage sizes = sizes_over(8, 24, ramp);
  MeshingOptions options = with(sizes);
  options.sizes.target_elements = 6000;
  const MeshingResult result = mesh_image(ball(24, 9), options);
  EXPECT_NEAR(static_cast<double>(result.mesh.cells.size()), 6000, 300);
  EXPECT_NE(result.report.size_image_factor, 1);
  EXPECT_EQ(num_over(result.mesh, sizes, result.report.size_image_factor), 0);
}

double distance_to_plane(const Sphere& s, double x) { return std::fabs(s.center.x - x); }

// Labels 1 and 2 meet in the plane between voxels 9 and 10.
LabelImage two_slabs() {
  return make_image({20, 20, 20}, {1, 1, 1}, 2, [](int i, int, int) { return i < 10 ? 1 : 2; });
}
constexpr double kPlane = -7 + 9.5;

MeshingOptions near_plane(double grade) {
  MeshingOptions options;
  options.sizes.radius_mm = 4;
  options.sizes.near = {{.labels = {{{10}, {20}}}, .radius_mm = 0.8, .width_mm = 1.5}};
  options.sizes.grade = grade;
  options.team.threads = 1;
  return options;
}

TEST(SizesByPlace, BoundCellsNearAnInterfaceAndHardlyElsewhere) {
  const MeshingResult result = mesh_image(two_slabs(), near_plane(0));
  EXPECT_TRUE(result.report.guarantees.all_met());
  std::size_t near = 0, large = 0;
  for (const Sphere& sphere : spheres_of(result.mesh)) {
    const double distance = distance_to_plane(sphere, kPlane);
    if (distance <= 1.5) {
      ++near;
      EXPECT_LE(sphere.radius, 0.8);
    }
    large += distance > 1.5 + std::sqrt(3.0) && sphere.radius > 0.9;
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(large, 50);
}

TEST(SizesByPlace, GrowNoFasterThanTheGrade) {
  const MeshingResult result = mesh_image(two_slabs(), near_plane(0.2));
  for (const Sphere& sphere : spheres_of(result.mesh)) {
    const double beyond = std::max(0.0, distance_to_plane(sphere, kPlane) - 1.5);
    EXPECT_LE(sphere.radius, 0.8 + 0.2 * (beyond + std::sqrt(3.0))) << "a voxel's diagonal for interpolation";
  }
  EXPECT_GT(result.mesh.cells.size(), mesh_image(two_slabs(), near_plane(0)).mesh.cells.size());
}

TEST(SizesByPlace, AreGradedFromLabelToLabel) {
  MeshingOptions options;
  options.sizes.radius_mm = 5;
  options.sizes.radius_of_mm[10] = 0.8;
  options.sizes.grade = 0.25;
  options.team.threads = 1;
  const LabelImage image = two_slabs();
  const auto grid = make_size_grid(image, options.sizes, 1);
  for (int i = 0; i < 100; ++i) {
    const Point p{-7 + 0.19 * i, 18 + 0.03 * i, 12};
    const double beyond = std::max(0.0, p.x - kPlane);
    EXPECT_LE(grid->radius_at(p), 0.8 + 0.25 * (beyond + 1));
    EXPECT_GE(grid->radius_at(p), std::min(5.0, 0.8 + 0.25 / 1.13 * beyond) * (1 - 1e-6));
  }
}

TEST(SizesByPlace, ArePredicted) {
  const LabelImage image = ball(60, 27);
  MeshingOptions options = with(sizes_over(8, 60, [](const Point& p) { return 1.2 + 0.05 * (p.x + 9); }));
  const auto cells = static_cast<double>(mesh_image(image, options).mesh.cells.size());
  EXPECT_NEAR(estimate(image, options).cells, cells, 0.2 * cells);
}

TEST(SizesByPlace, ArePredictedWhereZonesAreNarrowerThanAVoxel) {
  const LabelImage image = ball(24, 9);
  for (const double width : {0.2, 0.4}) {
    MeshingOptions options;
    options.sizes.radius_mm = 4;
    options.sizes.near = {{.labels = {{{10}, {0}}}, .radius_mm = 0.3, .width_mm = width}};
    options.team.threads = 1;
    const auto cells = static_cast<double>(mesh_image(image, options).mesh.cells.size());
    EXPECT_NEAR(estimate(image, options).cells, cells, 0.25 * cells) << width;
    options.sizes.near[0].radius_mm = 1e-6;
    EXPECT_GT(estimate(image, options).cells, 1e12);
  }
}

// Samples in regions of large cells must not remove vertices from regions of small cells, which would be
// inserted again.
TEST(SizesByPlace, KeepWhatTheyAskForWhereTheyJump) {
  const SizeImage jump = sizes_over(41, 24, [](const Point& p) { return p.x < 2 ? 0.5 : 6; });
  MeshingOptions options = with(jump);
  options.sizes.delta_mm = 3;
  const MeshingResult result = mesh_image(ball(24, 9), options);
  EXPECT_EQ(num_over(result.mesh, jump), 0);
  EXPECT_LT(result.report.counters.removals, 1.5 * static_cast<double>(result.mesh.vertices.size()));
}

TEST(SizesByPlace, AreRefusedWhereTheyAreSenseless) {
  const LabelImage image = two_slabs();
  const auto refusal = [&](const MeshingOptions& options) {
    return fault_of<InputError>([&] { mesh_image(image, options); });
  };
  SizeImage far = sizes_over(3, 20, ramp);
  far.voxel_to_ras[3] = 1000;
  EXPECT_NE(refusal(with(far)).find("sizes.nii: the size image and the object do not overlap"),
            std::string::npos);
  EXPECT_NE(
      refusal(with(sizes_over(30, 60, [](const Point& p) { return p.x > 40 ? 1 : 0; }))).find("sizes.nii"),
      std::string::npos);
  SizeImage nan = sizes_over(3, 20, ramp);
  nan.radius_mm[5] = std::nanf("");
  EXPECT_NE(refusal(with(nan)).find("sizes.nii: radii must be finite"), std::string::npos);
  for (const double grade : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_NE(refusal(near_plane(grade)).find("is not a positive number"), std::string::npos);
  MeshingOptions apart = near_plane(0);
  const LabelImage separate = make_image({20, 20, 20}, {1, 1, 1}, 2, [](int i, int, int) {
    return i < 8 ? 1 : i < 12 ? 0 : 2;
  });
  EXPECT_NE(fault_of<InputError>([&] {
              mesh_image(separate, apart);
            }).find("labels 10 and 20: they have no voxels that touch"),
            std::string::npos);
  apart.sizes.near[0].labels[1] = {10};
  EXPECT_NE(refusal(apart).find("10 is on both sides"), std::string::npos);
  apart.sizes.near[0].labels[1] = {77};
  EXPECT_NE(refusal(apart).find("interface of label 77"), std::string::npos);
}

}  // namespace
}  // namespace podm
