// The oracle with a flat box, beside direct implementations of its definition.
#include <gtest/gtest.h>

#include <cmath>

#include "isosurface/isosurface.h"
#include "isosurface_reference.h"

namespace podm::test {
namespace {

struct BoxSample {
  LabelImage image;
  std::shared_ptr<const VoxelWeights> weights;
};

std::vector<BoxSample> noisy_boxes() {
  Random random(31);
  std::vector<BoxSample> samples;
  for (int n = 0; n < 24; ++n) {
    const std::array<int, 3> size = n % 6 == 5 ? std::array{5, 1, 4} : std::array{5, 5, 5};
    const std::array<double, 3> spacing = n % 2 == 0 ? std::array{1.0, 1.0, 1.0} : std::array{0.6, 0.9, 1.4};
    LabelImage image = random_image(random, size, spacing, 2 + n % 3, 0.2 * (n % 5));
    image.is_box_flat = true;
    const auto weights = n % 4 == 3 ? random_weights(random, image) : nullptr;
    samples.push_back({std::move(image), weights});
  }
  return samples;
}

// The frame of these images has its origin at the first voxel's center.
Point clamped(const LabelImage& image, const Point& p, double beyond) {
  const auto along = [&](double x, std::size_t a) {
    return std::clamp(x, -beyond * image.spacing[a], (image.size[a] - 1 + beyond) * image.spacing[a]);
  };
  return {along(p.x, 0), along(p.y, 1), along(p.z, 2)};
}

bool is_in_box(const LabelImage& image, const Point& p) {
  return squared_distance(p, clamped(image, p, 0.5)) == 0;
}

ReferenceLabel label_in_flat_box(const BoxSample& of, const Point& p) {
  if (!is_in_box(of.image, p)) return {kBackground, 1};
  return reference_label(of.image, clamped(of.image, p, 0), of.weights.get());
}

// Points of the isosurface along the lines of a lattice, found by the definition.
std::vector<Point> surface_of(const BoxSample& of, int per_voxel) {
  std::vector<Point> points;
  const auto along = [&](std::size_t axis, int n) {
    return (-0.8 + (n + 0.37) / per_voxel) * of.image.spacing[axis];
  };
  const auto count = [&](std::size_t a) { return static_cast<int>((of.image.size[a] + 0.8) * per_voxel); };
  const auto add = [&](Point low, Point high) {
    const LabelIndex label = label_in_flat_box(of, low).label;
    if (label_in_flat_box(of, high).label == label) return;
    for (int i = 0; i < 45; ++i) {
      const Point middle = 0.5 * (low + high);
      (label_in_flat_box(of, middle).label == label ? low : high) = middle;
    }
    points.push_back(low);
  };
  for (int i = 0; i < count(0); ++i)
    for (int j = 0; j < count(1); ++j)
      for (int k = 0; k < count(2); ++k) {
        const Point p{along(0, i), along(1, j), along(2, k)};
        add(p, {along(0, i + 1), p.y, p.z});
        add(p, {p.x, along(1, j + 1), p.z});
        add(p, {p.x, p.y, along(2, k + 1)});
      }
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
  return points;
}

bool label_changes_near(const BoxSample& of, const Point& p, double voxels) {
  const LabelIndex own = label_in_flat_box(of, p).label;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const auto& s = of.image.spacing;
        const Vector d{i * voxels * s[0], j * voxels * s[1], k * voxels * s[2]};
        if (label_in_flat_box(of, p + d).label != own) return true;
      }
  return false;
}

// A point on sides has exactly the coordinates of their planes.
void expect_on_planes(const LabelImage& image, const SurfacePoint& z) {
  const std::array<double, 3> at{z.x, z.y, z.z};
  for (std::size_t side = 0; side < kNumSides; ++side) {
    if ((z.sides >> side & 1) == 0) continue;
    const std::size_t a = side / 2;
    ASSERT_EQ(at[a], (side % 2 == 0 ? -0.5 : image.size[a] - 0.5) * image.spacing[a]);
  }
}

TEST(FlatBox, LabelsEqualTheDefinition) {
  Random random(32);
  for (const BoxSample& of : noisy_boxes()) {
    const Isosurface isosurface(of.image, 1, of.weights);
    for (int n = 0; n < 2000; ++n) {
      const Point p = random_point(random, of.image, n % 10 == 0 ? 20 : 1);
      const ReferenceLabel expected = label_in_flat_box(of, p);
      if (expected.lead <= 1e-12) continue;
      ASSERT_EQ(isosurface.label_at(p), expected.label);
      ASSERT_EQ(isosurface.label_and_bound(p, 1).label, expected.label);
    }
  }
}

TEST(FlatBox, NearPointsAndBoundsAgreeWithTheDefinition) {
  Random random(33);
  int num_found = 0, num_far = 0, num_on_sides = 0;
  for (const BoxSample& of : noisy_boxes()) {
    const Isosurface isosurface(of.image, 1, of.weights);
    const std::vector<Point> surface = surface_of(of, 4);
    const auto& s = of.image.spacing;
    const double longest = std::max({s[0], s[1], s[2]});
    for (int n = 0; n < 150 && !surface.empty(); ++n) {
      const Point p = random_point(random, of.image, 2);
      const double nearest = distance_to_nearest(surface, p);
      ASSERT_LE(isosurface.distance_lower_bound(p, 1e9), nearest * (1 + 1e-9));
      const auto near = isosurface.near_point(p, 1e9);
      ASSERT_TRUE(near);
      const SurfacePoint z = isosurface.polished(*near, p);
      expect_on_planes(of.image, z);
      ASSERT_TRUE(label_changes_near(of, z, 1e-5)) << z.x << ' ' << z.y << ' ' << z.z << " of " << p.x;
      num_far += distance(z, p) > nearest + longest;
      num_on_sides += z.sides != 0;
      ++num_found;
    }
  }
  EXPECT_GT(num_found, 2000);
  EXPECT_GT(num_on_sides, 200);
  EXPECT_LT(num_far, num_found / 50);
}

TEST(FlatBox, SegmentsCrossWhereTheLabelChanges) {
  Random random(34);
  int num_exits = 0;
  for (const BoxSample& of : noisy_boxes()) {
    const Isosurface isosurface(of.image, 1, of.weights);
    for (int n = 0; n < 400; ++n) {
      const Point a = random_point(random, of.image, 2), b = random_point(random, of.image, 2);
      const ReferenceLabel at_a = label_in_flat_box(of, a), at_b = label_in_flat_box(of, b);
      if (at_a.lead < 1e-9 || at_b.lead < 1e-9) continue;
      const auto z = isosurface.segment_intersection(a, b);
      if (at_a.label != at_b.label) {
        ASSERT_TRUE(z);
      }
      if (at_a.label == at_b.label) {
        ASSERT_EQ(isosurface.is_crossed(a, b, at_a.label), z.has_value());
      }
      if (!z) continue;
      expect_on_planes(of.image, *z);
      ASSERT_TRUE(label_changes_near(of, *z, 1e-5));
      for (double t = 0.001; t < 0.98; t += 0.02)
        ASSERT_EQ(label_in_flat_box(of, a + t * (*z - a)).label, at_a.label);
      if (const auto exit = isosurface.exit_through_side(a, b)) {
        ++num_exits;
        ASSERT_NE(exit->sides, 0);
        ASSERT_NE(is_in_box(of.image, a), is_in_box(of.image, b));
        expect_on_planes(of.image, *exit);
        const SurfacePoint settled = isosurface.settled_on_edge(*exit, 0.8);
        expect_on_planes(of.image, settled);
        ASSERT_EQ(settled.sides & exit->sides, exit->sides);
        ASSERT_LE(distance(settled, *exit), 0.8 * (1 + 1e-9));
        ASSERT_TRUE(label_changes_near(of, settled, 1e-5));
      }
    }
  }
  EXPECT_GT(num_exits, 500);
}

TEST(FlatBox, PlanesFollowPermutedAxes) {
  LabelImage image = empty_image({4, 3, 2}, {1, 2, 3});
  image.is_box_flat = true;
  image.voxel_to_ras = {0, -2, 0, 5, 0, 0, 3, 6, 1, 0, 0, 7};
  const BoxPlanes planes(image);
  EXPECT_TRUE(planes.contains({5, 6, 7}));
  const SurfacePoint z = planes.clamped({100, 6, 7});
  EXPECT_EQ(z.x, 6);
  EXPECT_EQ(z.sides, 1 << 2);  // j-
  const SurfacePoint corner = planes.clamped({-100, 100, -100});
  EXPECT_EQ(corner.x, 0);
  EXPECT_EQ(corner.y, 10.5);
  EXPECT_EQ(corner.z, 6.5);
  EXPECT_EQ(corner.sides, 1 << 0 | 1 << 3 | 1 << 5);
}

// A point that is near two planes moves onto one of them if both are too far together.
TEST(FlatBox, PointsMoveOntoThePlanesThatAreWithinReach) {
  LabelImage image = empty_image({4, 3, 2}, {1, 2, 3});
  image.is_box_flat = true;
  const BoxPlanes planes(image);  // from (-0.5, -1, -1.5)
  const SurfacePoint z{{-0.1, -0.8, 0.5}};
  EXPECT_EQ(planes.snapped(z, 0.1).sides, 0);
  EXPECT_EQ(planes.snapped(z, 0.3).sides, 1 << 2);
  EXPECT_EQ(planes.snapped(z, 0.3).y, -1);
  EXPECT_EQ(planes.snapped(z, 0.3).x, z.x);
  EXPECT_EQ(planes.snapped(z, 0.5).sides, 1 << 0 | 1 << 2);
  EXPECT_EQ(planes.snapped(z, 10).sides, 1 << 0 | 1 << 2);  // z is 0.67 voxels from the third plane
  EXPECT_EQ(planes.onto_planes(z, 10).sides, 1 << 0 | 1 << 2 | 1 << 4);
}

}  // namespace
}  // namespace podm::test
