#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "closest_point.h"
#include "image/working_frame.h"
#include "isosurface/isosurface.h"
#include "isosurface_reference.h"
#include "smoothing/smooth_interfaces.h"

namespace podm::test {
namespace {

constexpr double kOnSurfaceVoxels = 1e-6;

std::vector<LabelImage> noisy_images() {
  Random random(11);
  std::vector<LabelImage> images;
  for (const unsigned num_labels : {2u, 3u, 9u}) {
    for (const double coherence : {0.0, 0.9, 0.98}) {
      images.push_back(random_image(random, {9, 8, 10}, {1, 1, 1}, num_labels, coherence));
      images.push_back(random_image(random, {12, 7, 5}, {0.6, 0.6, 1.3}, num_labels, coherence));
    }
  }
  // The first image has more labels than the words have room for. Those of the second just have room or just
  // have not. The third has voxels six times as long as wide.
  images.push_back(random_image(random, {60, 30, 25}, {1, 1, 1}, 40'000, 0.5));
  images.push_back(random_image(random, {11, 9, 13}, {1, 1, 1.5}, 7, 0.8));
  for (LabelIndex& label : images.back().voxels)
    if (label != kBackground) label += StoredFeature::kLabelTooLarge - 4;
  images.push_back(random_image(random, {12, 11, 7}, {0.5, 0.5, 3}, 3, 0.9));
  images.push_back(random_image(random, {1, 6, 7}, {1, 2, 1}, 3, 0.5));
  images.push_back(random_image(random, {5, 1, 1}, {1, 1, 1}, 2, 0.0));
  images.push_back(empty_image({6, 6, 6}, {1, 1, 1}));
  images.push_back(empty_image({7, 7, 7}, {1, 1, 0.5}));
  images.back().voxels[images.back().index(3, 3, 3)] = 1;
  images.push_back(empty_image({7, 5, 4}, {1, 1, 1}));
  std::fill(images.back().voxels.begin(), images.back().voxels.end(), LabelIndex{1});
  return images;
}

// An image and its voxel weights.
struct Sample {
  LabelImage image;
  std::shared_ptr<const VoxelWeights> weights;
};

std::vector<Sample> noisy_samples() {
  Random random(21);
  std::vector<Sample> samples;
  for (LabelImage& image : noisy_images()) {
    samples.push_back({image, nullptr});
    samples.push_back({image, random_weights(random, image)});
  }
  return samples;
}

// Each phantom with stairs and smoothed.
std::vector<Sample> smooth_samples() {
  std::vector<Sample> samples;
  for (Phantom& phantom : smooth_phantoms()) {
    phantom.image.labels.resize(3);
    samples.push_back({phantom.image, nullptr});
    samples.push_back({phantom.image, smooth_interfaces(phantom.image, 1.5, 1).weights});
  }
  return samples;
}

double shortest_voxel_side(const LabelImage& image) {
  return std::min({image.spacing[0], image.spacing[1], image.spacing[2]});
}

TEST(IsosurfaceLabel, EqualsTheDefinition) {
  Random random(3);
  for (const auto& [image, weights] : noisy_samples()) {
    const Isosurface isosurface(image, 1, weights);
    for (int n = 0; n < 3000; ++n) {
      const Point p = random_point(random, image, n % 10 == 0 ? 30 : 1);
      const ReferenceLabel expected = reference_label(image, p, weights.get());
      if (expected.lead > 1e-12) {
        ASSERT_EQ(isosurface.label_at(p), expected.label);
      }
    }
  }
}

// A point anywhere, or one where answers change: at a center of a voxel or of a block, or on the border
// between two voxels or of the grid.
Point special_point(Random& random, const LabelImage& image) {
  const auto along = [&](std::size_t a) {
    const auto half_sides = static_cast<double>(random() % (2 * static_cast<unsigned>(image.size[a]) + 5));
    return (0.5 * half_sides - 1.5) * image.spacing[a];
  };
  Point p = random_point(random, image, random() % 8 == 0 ? 30 : 1);
  if (random() % 2 == 0) p.x = along(0);
  if (random() % 2 == 0) p.y = along(1);
  if (random() % 2 == 0) p.z = along(2);
  return p;
}

TEST(LabelAndBound, AreThoseOfTheirOwnQueries) {
  Random random(15);
  int num_outside = 0, num_far = 0;
  for (const auto& [image, weights] : noisy_samples()) {
    const Isosurface isosurface(image, 1, weights);
    for (int n = 0; n < 3000; ++n) {
      const Point p = special_point(random, image);
      const double radius = n % 10 == 0 ? 1e9 : uniform(random, 0, 6);
      const LabelAndBound found = isosurface.label_and_bound(p, radius);
      ASSERT_EQ(found.label, isosurface.label_at(p)) << p.x << ' ' << p.y << ' ' << p.z;
      ASSERT_EQ(found.bound, isosurface.distance_lower_bound(p, radius)) << p.x << ' ' << p.y << ' ' << p.z;
      const ReferenceLabel expected = reference_label(image, p, weights.get());
      if (expected.lead > 1e-12) {
        ASSERT_EQ(found.label, expected.label) << p.x << ' ' << p.y << ' ' << p.z;
      }
      num_outside += p.x < 0 || p.y < 0 || p.z < 0;
      num_far += found.bound > radius;
    }
  }
  EXPECT_GT(num_outside, 1000);
  EXPECT_GT(num_far, 1000);
}

TEST(LabelAndBound, AreThoseOfTheirOwnQueriesFarFromTheIsosurface) {
  Random random(16);
  LabelImage image = empty_image({61, 47, 50}, {0.617, 0.617, 1.333});
  for (int n = 0; n < 6; ++n) image.voxels[random() % image.num_voxels()] = 600;
  for (const auto& weights : {std::shared_ptr<const VoxelWeights>(), random_weights(random, image)}) {
    const Isosurface isosurface(image, 1, weights);
    const std::vector<Point> surface = sample_isosurface(image, 2, weights.get());
    for (int n = 0; n < 2000; ++n) {
      const Point p = special_point(random, image);
      const double radius = uniform(random, 0, 30);
      const LabelAndBound found = isosurface.label_and_bound(p, radius);
      ASSERT_EQ(found.label, isosurface.label_at(p));
      ASSERT_EQ(found.bound, isosurface.distance_lower_bound(p, radius));
      ASSERT_LE(found.bound, distance_to_nearest(surface, p) * (1 + 1e-12));
    }
  }
}

// Equal queries in another frame give equal answers in that frame.
TEST(IsosurfaceFrame, CarriesAnswersAlong) {
  Random random(5);
  for (const LabelImage& image : noisy_images()) {
    const Isosurface expected(image, 1);
    LabelImage moved = image;
    const double c = std::cos(0.7), s = std::sin(0.7);
    const auto [x, y, z] = image.spacing;
    moved.voxel_to_ras = {0, -c * y, s * z, 31, -x, 0, 0, -5, 0, -s * y, -c * z, 250};
    const Isosurface isosurface(moved, 1);
    for (int n = 0; n < 300; ++n) {
      const Point p = random_point(random, image, n % 10 == 0 ? 30 : 1);
      const Point q = map(moved.voxel_to_ras, Point{p.x / x, p.y / y, p.z / z});
      if (reference_label(image, p).lead > 1e-9) {
        ASSERT_EQ(isosurface.label_at(q), expected.label_at(p));
      }
      const double radius = uniform(random, 0, 4), bound = expected.distance_lower_bound(p, 100);
      if (std::isfinite(bound)) {
        ASSERT_NEAR(isosurface.distance_lower_bound(q, 100), bound, 1e-9);
      }
      const auto near = closest_point(isosurface, q, radius);
      if (!near) continue;
      ASSERT_LE(distance(*near, q), radius + shortest_voxel_side(image));
      const Point u = map(inverse(moved.voxel_to_ras), *near);
      ASSERT_TRUE(is_on_isosurface(image, {u.x * x, u.y * y, u.z * z}, kOnSurfaceVoxels));
    }
  }
}

TEST(IsosurfaceFrame, IsTheImagesOwnUnderShear) {
  Random random(5);
  const LabelImage image = random_image(random, {9, 8, 10}, {1, 1.5, 2}, 3, 0.9);
  LabelImage sheared = image;
  sheared.voxel_to_ras = {1, 0.5, 0, 8, 0, std::sqrt(2.0), 0, 3, 0, 0, 2, -7};
  const Isosurface expected(image, 1), isosurface(sheared, 1);
  for (int n = 0; n < 300; ++n) {
    const Point p = random_point(random, image, 1);
    ASSERT_EQ(isosurface.label_at(p), expected.label_at(p));
    ASSERT_EQ(closest_point(isosurface, p, 3), closest_point(expected, p, 3));
    const Point world = map(working_to_world(sheared), p);
    const Point mapped = map(sheared.voxel_to_ras, Point{p.x, p.y / 1.5, p.z / 2});
    ASSERT_NEAR(distance(world, mapped), 0, 1e-12);
  }
}

struct Reads {
  std::uint64_t image = 0, transform = 0;
};

// The numbers of reads that `ask` causes. Its results must equal those of the oracle that does not count. Two
// nodes own parts of the memory in turn.
template <class Ask>
Reads reads_of(const LabelImage& image, const Isosurface& isosurface, const Ask& ask) {
  const std::vector<NodeIndex> nodes{0, 1};
  const ImageOwners owners{MemoryOwners::deal(std::span(image.voxels), 3, nodes, 1),
                           MemoryOwners::deal(isosurface.transform().words(), 3, nodes, 2)};
  AccessTally tally(2);
  const Oracle<CountedReads> counted = isosurface.counted({owners, tally});
  EXPECT_EQ(ask(isosurface), ask(counted));
  const auto sum = [&](AccessKind kind) { return tally.by_node(kind)[0] + tally.by_node(kind)[1]; };
  return {sum(AccessKind::kImageRead), sum(AccessKind::kTransformRead)};
}

TEST(IsosurfaceReads, AreCountedAndChangeNoAnswer) {
  Random random(7);
  for (const LabelImage& image : noisy_images()) {
    const Isosurface isosurface(image, 1);
    const auto reads = [&](const auto& ask) { return reads_of(image, isosurface, ask); };
    for (int n = 0; n < 200; ++n) {
      const Point p = random_point(random, image, 1), q = random_point(random, image, 1);
      const double radius = 3;
      const Reads of_label = reads([&](const auto& oracle) { return oracle.label_at(p); });
      EXPECT_LE(of_label.transform, 4u) << "the table, a word, a mask and a neighborhood";
      EXPECT_LE(of_label.image, 8u) << "a block";
      const Reads of_bound =
          reads([&](const auto& oracle) { return oracle.distance_lower_bound(p, radius); });
      EXPECT_GE(of_bound.transform, 1u);
      EXPECT_EQ(of_bound.image, 0u);
      const Reads of_both = reads([&](const auto& oracle) {
        const auto [label, bound] = oracle.label_and_bound(p, radius);
        return std::pair(label, bound);
      });
      EXPECT_EQ(of_both.image, of_label.image);
      const unsigned num_shared = of_label.transform > 0 ? 1 : 0;  // at least the entry of the table
      EXPECT_LE(of_both.transform + num_shared, of_label.transform + of_bound.transform);
      const Reads of_crossing = reads([&](const auto& oracle) {
        const auto z = oracle.segment_intersection(p, q);
        return z ? std::array{z->x, z->y, z->z} : std::array<double, 3>{};
      });
      EXPECT_LE(of_label.image, of_crossing.image);
      const Reads of_nearest = reads([&](const auto& oracle) {
        const auto z = closest_point(oracle, p, radius);
        return z ? std::array{z->x, z->y, z->z} : std::array<double, 3>{};
      });
      EXPECT_EQ(of_nearest.transform > 0, std::isfinite(isosurface.distance_lower_bound(p, radius)));
    }
  }
}

// Away from any label change one read of the table of bricks suffices.
TEST(IsosurfaceReads, IsOneDeepInside) {
  LabelImage image = empty_image({28, 28, 28}, {1, 1, 1});
  std::fill(image.voxels.begin(), image.voxels.end(), LabelIndex{1});
  const Isosurface isosurface(image, 1);
  const auto expect_one = [&](const auto& ask) {
    const Reads reads = reads_of(image, isosurface, ask);
    EXPECT_EQ(reads.image, 0u);
    EXPECT_EQ(reads.transform, 1u);
  };
  const Point deep{13.1, 14.2, 13.8};
  expect_one([&](const auto& oracle) { return oracle.label_at(deep); });
  expect_one([&](const auto& oracle) { return oracle.distance_lower_bound(deep, 3); });
}

// With spacing 1, weights at quarters of a voxel are exact, and so are ties.
TEST(IsosurfaceLabel, TiesGoToTheSmallerLabel) {
  Random random(4);
  for (const unsigned num_labels : {2u, 3u, 9u}) {
    const LabelImage image = random_image(random, {6, 6, 6}, {1, 1, 1}, num_labels, 0.5);
    const Isosurface isosurface(image, 1);
    for (double z = -1.5; z <= 6.5; z += 0.25)
      for (double y = -1.5; y <= 6.5; y += 0.25)
        for (double x = -1.5; x <= 6.5; x += 0.25)
          ASSERT_EQ(isosurface.label_at({x, y, z}), reference_label(image, {x, y, z}).label)
              << x << ' ' << y << ' ' << z;
  }
}

TEST(IsosurfaceDistance, NeverExceedsTheDistanceToAnySurfacePoint) {
  Random random(5);
  std::vector<Sample> samples = noisy_samples();
  for (Sample& sample : smooth_samples()) samples.push_back(std::move(sample));
  for (const auto& [image, weights] : samples) {
    const Isosurface isosurface(image, 1, weights);
    const std::vector<Point> surface = sample_isosurface(image, 3, weights.get());
    for (int n = 0; n < 400; ++n) {
      const Point p = random_point(random, image, n % 10 == 0 ? 30 : 2);
      const double radius = uniform(random, 0, 3) * shortest_voxel_side(image);
      const double bound = isosurface.distance_lower_bound(p, radius);
      ASSERT_GE(bound, 0);
      ASSERT_LE(bound, distance_to_nearest(surface, p) * (1 + 1e-12));
    }
  }
}

TEST(IsosurfaceDistance, IsComparedWithTheRadiusInTheGrid) {
  for (const auto& [image, weights] : smooth_samples()) {
    const Isosurface isosurface(image, 1, weights);
    const std::vector<Point> surface = sample_isosurface(image, 2, weights.get());
    // The bound is derived from surface voxels.
    const double voxel_diagonal =
        (weights ? 2 : 1) * std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]);
    Random random(6);
    for (int n = 0; n < 300; ++n) {
      const Point p = random_point(random, image, 0);
      const double radius = uniform(random, 0, 8);
      if (distance_to_nearest(surface, p) > radius + 2 * voxel_diagonal) {
        EXPECT_GT(isosurface.distance_lower_bound(p, radius), radius);
      }
    }
  }
}

TEST(ClosestPoint, LiesOnTheIsosurfaceWithinTheRadius) {
  Random random(7);
  for (const auto& [image, weights] : noisy_samples()) {
    const Isosurface isosurface(image, 1, weights);
    for (int n = 0; n < 500; ++n) {
      const Point p = random_point(random, image, 2);
      const double radius = uniform(random, 0, 4);
      const auto z = closest_point(isosurface, p, radius);
      if (!z) continue;
      ASSERT_LE(distance(p, *z), radius * (1 + 1e-12));
      ASSERT_GE(distance(p, *z), isosurface.distance_lower_bound(p, radius) * (1 - 1e-9));
      ASSERT_TRUE(is_on_isosurface(image, *z, kOnSurfaceVoxels, weights.get()));
    }
  }
}

// The excess over the distance to the nearest point, mm, in ascending order.
std::vector<double> excess_mm(const Sample& sample) {
  const LabelImage& image = sample.image;
  const Isosurface isosurface(image, 1, sample.weights);
  const std::vector<Point> surface = sample_isosurface(image, 6, sample.weights.get());
  Random random(8);
  std::vector<double> excess;
  for (int n = 0; n < 10'000; ++n) {
    const Point p = random_point(random, image, 1);
    const auto z = closest_point(isosurface, p, 1e9);
    EXPECT_TRUE(z);
    if (z) excess.push_back(distance(p, *z) - distance_to_nearest(surface, p));
  }
  std::sort(excess.begin(), excess.end());
  return excess;
}

// The excess over the distance to the nearest point, in voxel sides. Voxelised smooth shapes have bumps of
// voxel size, and the search may end at the second nearest. The excess may be negative because the samples
// are not dense.
constexpr double kMedianExcess = 0.001, k99PercentExcess = 0.25, kGreatestExcess = 1;

TEST(ClosestPoint, IsNearestOnSmoothPhantoms) {
  int number = 0;
  for (const Sample& sample : smooth_samples()) {
    SCOPED_TRACE(number++);
    const std::vector<double> excess = excess_mm(sample);
    ASSERT_EQ(excess.size(), 10'000u);
    const double side = shortest_voxel_side(sample.image);
    EXPECT_LE(excess[5000], kMedianExcess * side);
    EXPECT_LE(excess[9900], k99PercentExcess * side);
    EXPECT_LE(excess[9999], kGreatestExcess * side);
  }
}

// Features are nearest by centers. The midpoint on a long side is half of that side away from its feature.
TEST(ClosestPoint, IsNearByTheLongestSide) {
  constexpr double k99Percent = 0.55, kGreatest = 0.75;
  const Phantom phantom = sphere_of_long_voxels();
  const std::vector<double> excess = excess_mm({phantom.image, nullptr});
  ASSERT_EQ(excess.size(), 10'000u);
  EXPECT_LE(excess[5000], 0.01 * phantom.image.spacing[2]);
  EXPECT_LE(excess[9900], k99Percent * phantom.image.spacing[2]);
  EXPECT_LE(excess[9999], kGreatest * phantom.image.spacing[2]);
}

// Far outside, bumps of voxel size stop a local search early.
constexpr double kFarExcess = 4;

TEST(ClosestPoint, IsNearFromFarOutside) {
  for (const auto& [image, weights] : smooth_samples()) {
    const Isosurface isosurface(image, 1, weights);
    const std::vector<Point> surface = sample_isosurface(image, 4, weights.get());
    const double side = shortest_voxel_side(image);
    Random random(13);
    for (int n = 0; n < 300; ++n) {
      const Point p = random_point(random, image, 60);
      const auto z = closest_point(isosurface, p, 1e9);
      ASSERT_TRUE(z);
      EXPECT_LE(distance(p, *z) - distance_to_nearest(surface, p), kFarExcess * side);
    }
  }
}

TEST(ClosestPoint, IsSeldomMissedOnSmoothPhantoms) {
  int number = 0;
  for (const auto& [image, weights] : smooth_samples()) {
    SCOPED_TRACE(number++);
    const Isosurface isosurface(image, 1, weights);
    const std::vector<Point> surface = sample_isosurface(image, 4, weights.get());
    const double side = shortest_voxel_side(image);
    Random random(9);
    int num_missed = 0;
    for (int n = 0; n < 10'000; ++n) {
      const Point p = random_point(random, image, 1);
      const double nearest = distance_to_nearest(surface, p);
      num_missed += !closest_point(isosurface, p, nearest / 0.95);
      EXPECT_TRUE(closest_point(isosurface, p, nearest + kGreatestExcess * side)) << nearest;
    }
    EXPECT_LE(num_missed, weights ? 150 : 100);
  }
}

TEST(SegmentIntersection, IsTheFirstChangeWhereLabelsDiffer) {
  Random random(10);
  for (const auto& [image, weights] : noisy_samples()) {
    const Isosurface isosurface(image, 1, weights);
    for (int n = 0; n < 2000; ++n) {
      const Point a = random_point(random, image, n % 10 == 0 ? 1000 : 1), b = random_point(random, image, 1);
      const auto z = isosurface.segment_intersection(a, b);
      if (!z) {
        ASSERT_EQ(isosurface.label_at(a), isosurface.label_at(b));
        continue;
      }
      const double length = distance(a, b), t = distance(a, *z) / length;
      ASSERT_NEAR(distance(a, *z) + distance(*z, b), length, 1e-9 * length);
      // Just before the point the label is still that of a. Just after it the label is another.
      const double step = kOnSurfaceVoxels * shortest_voxel_side(image) / length;
      if (t < step || t > 1 - step) continue;
      ASSERT_EQ(isosurface.label_at(a + (t - step) * (b - a)), isosurface.label_at(a));
      ASSERT_TRUE(is_on_isosurface(image, *z, kOnSurfaceVoxels, weights.get()));
      for (int i = 1; i < 20; ++i) {
        ASSERT_EQ(isosurface.label_at(a + (i / 20.0) * (t - step) * (b - a)), isosurface.label_at(a));
      }
    }
  }
}

TEST(SegmentIntersection, IsThereIfTheRestIsCrossedWhereNoIsosurfaceIsNear) {
  Random random(14);
  for (const auto& [image, weights] : noisy_samples()) {
    const Isosurface isosurface(image, 1, weights);
    int num_asked = 0;
    for (int n = 0; n < 20'000 && num_asked < 1000; ++n) {
      const Point a = random_point(random, image, 1), b = random_point(random, image, 1);
      const LabelIndex label = isosurface.label_at(a);
      const double length = distance(a, b), clear = isosurface.distance_lower_bound(a, length);
      if (isosurface.label_at(b) != label || clear >= length) continue;
      const Point rest = a + clear / length * (b - a);
      ASSERT_EQ(isosurface.is_crossed(rest, b, label), isosurface.segment_intersection(a, b).has_value());
      num_asked += clear > 0;
    }
  }
}

TEST(SegmentIntersection, FindsDoubleCrossings) {
  LabelImage image = empty_image({9, 9, 9}, {1, 1, 1});
  image.voxels[image.index(4, 4, 4)] = 1;
  const Isosurface isosurface(image, 1);
  const auto z = isosurface.segment_intersection({-100, 4, 4}, {100, 4, 4});
  ASSERT_TRUE(z);
  EXPECT_NEAR(z->x, 3.5, 1e-9);
  EXPECT_FALSE(isosurface.segment_intersection({-100, 4.6, 4}, {100, 4.6, 4}));
  EXPECT_FALSE(isosurface.segment_intersection({-100, -100, 4}, {-100, 100, 4}));
}

TEST(Isosurface, AnswersDoNotDependOnThreads) {
  Random random(12);
  const LabelImage image = random_image(random, {23, 19, 17}, {0.6, 0.7, 1.4}, 4, 0.97);
  const Isosurface one(image, 1), many(image, 3);
  for (int n = 0; n < 2000; ++n) {
    const Point a = random_point(random, image, 2), b = random_point(random, image, 2);
    ASSERT_EQ(one.label_at(a), many.label_at(a));
    ASSERT_EQ(one.distance_lower_bound(a, 1), many.distance_lower_bound(a, 1));
    ASSERT_EQ(closest_point(one, a, 5), closest_point(many, a, 5));
    ASSERT_EQ(one.segment_intersection(a, b), many.segment_intersection(a, b));
  }
}

TEST(Isosurface, OfAnEmptyImageIsEmpty) {
  const LabelImage image = empty_image({4, 4, 4}, {1, 1, 1});
  const Isosurface isosurface(image, 1);
  EXPECT_EQ(isosurface.label_at({1, 1, 1}), kBackground);
  EXPECT_EQ(isosurface.distance_lower_bound({1, 1, 1}, 1), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(closest_point(isosurface, {1, 1, 1}, 1e9));
  EXPECT_FALSE(isosurface.segment_intersection({-9, 1, 1}, {9, 2, 1}));
}

}  // namespace
}  // namespace podm::test
