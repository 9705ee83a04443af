#include "image/label_function.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "image/image_frame.h"

namespace podm::verify {
namespace {

Image random_image(unsigned seed, unsigned labels) {
  std::mt19937 random(seed);
  Image image;
  image.size = {4, 3, 5};
  image.spacing = {1, 1, 1};
  image.voxel_to_ras = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  image.voxels.resize(60);
  for (auto& v : image.voxels) v = random() % labels;
  return image;
}

Image with_random_voxel_weights(Image image) {
  std::mt19937 random(7);
  image.smoothing.emplace();
  for (std::size_t i = 0; i < image.voxels.size(); ++i)
    image.smoothing->voxel_weights.push_back(static_cast<std::uint16_t>(1 + random() % kFullVoxelWeight));
  return image;
}

// Returns the weight of the nearest voxel of the grid.
double voxel_weight(const Image& image, std::array<int, 3> v) {
  if (!image.smoothing) return 1;
  for (std::size_t axis = 0; axis < 3; ++axis) v[axis] = std::clamp(v[axis], 0, image.size[axis] - 1);
  return image.smoothing
             ->voxel_weights[static_cast<std::size_t>((v[2] * image.size[1] + v[1]) * image.size[0] + v[0])] /
         65535.0;
}

std::uint32_t voxel(const Image& image, int i, int j, int k) {
  if (i < 0 || j < 0 || k < 0 || i >= image.size[0] || j >= image.size[1] || k >= image.size[2]) return 0;
  return image.voxels[static_cast<std::size_t>((k * image.size[1] + j) * image.size[0] + i)];
}

void expect_hat_functions(const Image& image) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-2, 6);
  const LabelFunction function(image);
  for (int trial = 0; trial < 20000; ++trial) {
    const Point u{anywhere(random), anywhere(random), anywhere(random)};
    std::map<std::uint32_t, double> weights;
    for (int k = -3; k < 8; ++k)
      for (int j = -3; j < 8; ++j)
        for (int i = -3; i < 8; ++i) {
          const double weight = std::max(0.0, 1 - std::abs(u[0] - i)) *
                                std::max(0.0, 1 - std::abs(u[1] - j)) * std::max(0.0, 1 - std::abs(u[2] - k));
          if (weight > 0) weights[voxel(image, i, j, k)] += weight * voxel_weight(image, {i, j, k});
        }
    const LabelWeights found = function.weights_at(u);
    if (weights.size() == 1) weights.begin()->second = 1;  // one label alone has weight 1
    for (const auto& [label, weight] : weights) {
      EXPECT_NEAR(found.weight_of(label), weight, 1e-12);
      EXPECT_LE(weight, weights[function.label_at(u)] + 1e-12);
    }
  }
}

TEST(LabelFunction, IsTheGreatestSumOfHatFunctions) { expect_hat_functions(random_image(1, 4)); }

TEST(LabelFunction, IsTheGreatestSumOfHatFunctionsTimesVoxelWeights) {
  expect_hat_functions(with_random_voxel_weights(random_image(1, 4)));
}

TEST(LabelFunction, ChangesOnceBetweenTwoVoxels) {
  const Image image = with_random_voxel_weights(random_image(1, 4));
  const LabelFunction function(image), of_voxels = LabelFunction::of_voxels(image);
  for (int k = -1; k < image.size[2]; ++k)
    for (int j = 0; j < image.size[1]; ++j)
      for (int i = 0; i < image.size[0]; ++i) {
        const std::uint32_t first = voxel(image, i, j, k), second = voxel(image, i, j, k + 1);
        if (first == second) continue;
        const auto label_after = [&](const LabelFunction& f, double way) {
          return f.label_at({static_cast<double>(i), static_cast<double>(j), k + way});
        };
        for (const LabelFunction* f : {&function, &of_voxels}) {
          const double change = f->change_after({i, j, k}, 2);
          EXPECT_EQ(label_after(*f, change - 1e-9), first);
          EXPECT_EQ(label_after(*f, change + 1e-9), second);
        }
        EXPECT_EQ(of_voxels.change_after({i, j, k}, 2), 0.5);
      }
}

TEST(LabelFunction, TiesGoToTheSmallerLabelAndOutsideIsBackground) {
  Image image = random_image(1, 2);
  for (std::size_t i = 0; i < image.voxels.size(); ++i) image.voxels[i] = i % 4 < 2 ? 9 : 5;
  const LabelFunction function(image);
  EXPECT_EQ(function.label_at({1.5, 1, 1}), 5U);
  EXPECT_EQ(function.label_at({1.4999, 1, 1}), 9U);
  EXPECT_EQ(function.label_at({-0.4999, 1, 1}), 9U);
  EXPECT_EQ(function.label_at({-0.5, 1, 1}), 0U);
  EXPECT_EQ(function.label_at({1e300, -1e300, 1}), 0U);
}

// At multiples of 1/8 the weights are exact in doubles, and some of them tie.
void expect_exact_labels(const Image& image) {
  std::mt19937 random(9);
  const LabelFunction function(image);
  std::uint64_t num_exact = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Point u;
    std::array<mpq_class, 3> exact;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      u[axis] = (static_cast<int>(random() % 64) - 16) / 8.0;
      exact[axis] = mpq_class(u[axis]);
    }
    EXPECT_EQ(function.exact_label_at(exact), function.label_at(u));
    EXPECT_EQ(function.decided_label_at(u, num_exact), function.label_at(u));
  }
  EXPECT_GT(num_exact, 0U);
  EXPECT_LT(num_exact, 2000U);
}

TEST(LabelFunction, ExactLabelsAreThoseOfExactWeights) {
  expect_exact_labels(random_image(1, 4));
  Image image = with_random_voxel_weights(random_image(1, 4));
  for (auto& weight : image.smoothing->voxel_weights) weight = kFullVoxelWeight;
  expect_exact_labels(image);
}

TEST(LabelFunction, DecidesWhatRoundingLeavesOpen) {
  Image image = random_image(1, 2);
  for (std::size_t i = 0; i < image.voxels.size(); ++i) image.voxels[i] = i % 4 < 2 ? 9 : 5;
  const LabelFunction function(image);
  std::uint64_t num_exact = 0;
  EXPECT_EQ(function.decided_label_at({1.5, 1.3, 1.7}, num_exact), 5U) << "a tie";
  EXPECT_EQ(function.decided_label_at({std::nextafter(1.5, 0), 1.3, 1.7}, num_exact), 9U);
  EXPECT_EQ(function.decided_label_at({std::nextafter(1.5, 2), 1.3, 1.7}, num_exact), 5U);
  EXPECT_EQ(num_exact, 3U);
  EXPECT_EQ(function.decided_label_at({1.499, 1.3, 1.7}, num_exact), 9U);
  EXPECT_EQ(num_exact, 3U);
  // Voxel weights of 1 to 2 tie a third of the way, which is no double.
  image.smoothing.emplace();
  for (std::size_t i = 0; i < image.voxels.size(); ++i)
    image.smoothing->voxel_weights.push_back(i % 4 < 2 ? 1000 : 2000);
  const LabelFunction smoothed(image);
  const mpq_class third(4, 3), little(1, 1000000000);
  EXPECT_EQ(smoothed.exact_label_at({third, 1, 1}), 5U);
  EXPECT_EQ(smoothed.exact_label_at({third - little * little * little, 1, 1}), 9U);
  EXPECT_EQ(smoothed.exact_label_at({mpq_class(-1), 1, 1}), 0U);
  EXPECT_EQ(smoothed.exact_label_at({mpq_class(4), 1, 1}), 0U);
}

void expect_gradients(const Image& image) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> fraction(0.1, 0.9);
  const LabelFunction function(image);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 1000; ++trial) {
    Point u;
    for (std::size_t axis = 0; axis < 3; ++axis)
      u[axis] = static_cast<int>(random() % static_cast<unsigned>(image.size[axis])) + fraction(random);
    const Point gradient = function.gradient_of_difference(u, 1, 2);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Point low = u, high = u;
      low[axis] -= kStep;
      high[axis] += kStep;
      const auto difference = [&](const Point& p) {
        const LabelWeights w = function.weights_at(p);
        return w.weight_of(1) - w.weight_of(2);
      };
      EXPECT_NEAR(gradient[axis], (difference(high) - difference(low)) / (2 * kStep), 1e-8);
    }
  }
}

TEST(LabelFunction, GradientIsThatOfTheWeights) {
  expect_gradients(random_image(2, 3));
  expect_gradients(with_random_voxel_weights(random_image(2, 3)));
}

TEST(ImageFrame, GoesThereAndBackInEverySpace) {
  Image image = random_image(1, 2);
  image.voxel_to_ras = {-0.7, 0.2, 0, 30, 0.1, 0.9, 0.3, -200, 0, 0, 2.5, 7};
  for (const Space space : {Space::kUnstated, Space::kRas, Space::kLps, Space::kVoxel}) {
    const ImageFrame frame(image, space);
    const Point u{1.25, -3, 2}, world = frame.voxels_to_world(u);
    Point in_mesh = world;
    if (space == Space::kLps) in_mesh = {-world[0], -world[1], world[2]};
    if (space == Space::kVoxel) in_mesh = u;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(frame.to_voxels(in_mesh)[axis], u[axis], 1e-12);
      EXPECT_NEAR(frame.to_world(in_mesh)[axis], world[axis], 1e-12);
    }
  }
  EXPECT_NEAR(ImageFrame(image, Space::kVoxel).voxel_volume_mm3(), 2.5 * (0.63 + 0.02), 1e-12);
}

}  // namespace
}  // namespace podm::verify
