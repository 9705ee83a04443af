// Compares voxel weights with their definition, word for word, and checks properties of smoothed images.
#include "image/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "errors.h"
#include "image/label_function.h"

namespace podm::verify {
namespace {

using Voxel = std::array<int, 3>;
constexpr std::array<double, 3> kCubes{1, 1, 1};

Image image_of(const Voxel& size, const std::array<double, 3>& spacing,
               const std::function<std::uint32_t(int, int, int)>& label) {
  Image image;
  image.path = "made.nii";
  image.size = size;
  image.spacing = spacing;
  image.voxel_to_ras = {spacing[0], 0, 0, 0, 0, spacing[1], 0, 0, 0, 0, spacing[2], 0};
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) image.voxels.push_back(label(i, j, k));
  return image;
}

std::size_t place(const Image& image, const Voxel& v) {
  return static_cast<std::size_t>((v[2] * image.size[1] + v[1]) * image.size[0] + v[0]);
}

// Makes blobs: each voxel has the label of the nearest of some random points. A few voxels have any label.
Image random_image(unsigned seed, const Voxel& size, const std::array<double, 3>& spacing,
                   unsigned num_labels) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> anywhere(0, 1);
  std::vector<std::pair<std::array<double, 3>, std::uint32_t>> points;
  for (unsigned i = 0; i < 4 * num_labels; ++i)
    points.push_back({{size[0] * anywhere(random), size[1] * anywhere(random), size[2] * anywhere(random)},
                      5 * (i % num_labels)});
  return image_of(size, spacing, [&](int i, int j, int k) {
    if (random() % 40 == 0) return static_cast<std::uint32_t>(5 * (random() % num_labels));
    double nearest = 1e300;
    std::uint32_t label = 0;
    for (const auto& [p, of_point] : points) {
      const double squared = (p[0] - i) * (p[0] - i) + (p[1] - j) * (p[1] - j) + (p[2] - k) * (p[2] - k);
      if (squared < nearest) label = of_point;
      nearest = std::min(nearest, squared);
    }
    return label;
  });
}

// The definition of smoothing.h, voxel by voxel.
class ByDefinition {
 public:
  explicit ByDefinition(const Image& image)
      : image_(image), h_(std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2])) {}

  std::map<Voxel, long> voxel_weights(double width) const {
    const std::map<Voxel, double> depths = all_depths(width);
    std::map<Voxel, long> n;
    const double unit = std::max(1.1 * width, h_ / 2) / 65535;
    for (const auto& [v, depth] : depths)
      n[v] = std::min(std::lround(std::max(depth, h_ / 20) / unit), 65535L);
    for (int time = 0; time < 2; ++time) n = without_growth(n, width, std::lround(h_ / 20 / unit));
    return n;
  }

 private:
  std::map<Voxel, long> without_growth(const std::map<Voxel, long>& n, double width, long least) const {
    std::map<Voxel, long> result;
    for (const auto& [v, weight] : n) {
      const auto [area, lead] = faces_near(v, width, n);
      const double growth = area == 0 ? 0 : static_cast<double>(lead) / static_cast<double>(2 * area);
      result[v] = std::clamp(std::lround(static_cast<double>(weight) - growth), least, 65535L);
    }
    return result;
  }
  std::uint32_t label(const Voxel& v) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (v[axis] < 0 || v[axis] >= image_.size[axis]) return 0;
    return image_.voxels[place(image_, v)];
  }
  std::uint32_t clamped_label(Voxel v) const {
    for (std::size_t axis = 0; axis < 3; ++axis) v[axis] = std::clamp(v[axis], 0, image_.size[axis] - 1);
    return label(v);
  }

  static void for_box(const Voxel& center, const Voxel& reach,
                      const std::function<void(const Voxel&)>& visit) {
    for (int k = -reach[2]; k <= reach[2]; ++k)
      for (int j = -reach[1]; j <= reach[1]; ++j)
        for (int i = -reach[0]; i <= reach[0]; ++i) visit({center[0] + i, center[1] + j, center[2] + k});
  }

  std::set<Voxel> at_interfaces() const {
    std::set<Voxel> found;
    for (int k = 0; k < image_.size[2]; ++k)
      for (int j = 0; j < image_.size[1]; ++j)
        for (int i = 0; i < image_.size[0]; ++i)
          for_box({i, j, k}, {1, 1, 1}, [&](const Voxel& w) {
            if (label(w) != label({i, j, k})) found.insert({i, j, k});
          });
    return found;
  }

  // Returns the areas of the faces of v's label within twice the width, and the leads across them times these
  // areas.
  std::pair<long, long> faces_near(const Voxel& v, double width, const std::map<Voxel, long>& n) const {
    const double shortest = *std::min_element(image_.spacing.begin(), image_.spacing.end());
    Voxel reach;
    for (std::size_t axis = 0; axis < 3; ++axis)
      reach[axis] = static_cast<int>(std::ceil(2 * width / image_.spacing[axis] - 1e-5));
    std::pair<long, long> sums;
    for_box(v, reach, [&](const Voxel& w) {
      if (!n.contains(w) || label(w) != label(v)) return;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          Voxel beyond = w;
          beyond[axis] += step;
          if (beyond[axis] < 0 || beyond[axis] >= image_.size[axis] || label(beyond) == label(w)) continue;
          const long area = std::max(1L, std::lround(256 * shortest / image_.spacing[axis]));
          sums.first += area;
          sums.second += area * (n.at(w) - n.at(beyond));
        }
    });
    return sums;
  }

  void add_blurred(const Voxel& v, double s, double factor, std::map<std::uint32_t, double>& weights) const {
    Voxel reach;
    std::array<double, 3> sums{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      reach[axis] = static_cast<int>(std::ceil(3 * s / image_.spacing[axis] - 1e-5));
      for (int i = -reach[axis]; i <= reach[axis]; ++i) sums[axis] += gaussian(i * image_.spacing[axis], s);
    }
    for_box(v, reach, [&](const Voxel& w) {
      double tap = factor;
      for (std::size_t axis = 0; axis < 3; ++axis)
        tap *= gaussian((w[axis] - v[axis]) * image_.spacing[axis], s) / sums[axis];
      weights[clamped_label(w)] += tap;
    });
  }
  static double gaussian(double x, double s) { return std::exp(-x * x / (2 * s * s)); }

  double depth(const Voxel& v, double s) const {
    std::map<std::uint32_t, double> weights;
    add_blurred(v, s, 2, weights);
    add_blurred(v, 2 * s, -1, weights);
    double other = 0;
    for (const auto& [l, weight] : weights)
      if (l != label(v)) other = std::max(other, weight);
    return s * std::sqrt(2 * std::numbers::pi) / 3 * (weights[label(v)] - other);
  }

  std::map<Voxel, double> all_depths(double width) const {
    std::map<Voxel, double> depths;
    std::set<Voxel> open = at_interfaces();
    for (double s = width; !open.empty(); s /= 2) {
      if (s < (1 - 1e-5) * h_ / 2) {
        for (const Voxel& v : open) depths[v] = h_ / 2;
        break;
      }
      std::set<Voxel> near_lost;
      for (const Voxel& v : open) {
        depths[v] = std::max(depth(v, s), h_ / 20);
        if (depth(v, s) >= -h_ / 4) continue;
        Voxel reach;
        for (std::size_t axis = 0; axis < 3; ++axis)
          reach[axis] = static_cast<int>(std::ceil(2 * s / image_.spacing[axis] - 1e-5));
        for_box(v, reach, [&](const Voxel& w) { near_lost.insert(w); });
      }
      std::erase_if(open, [&](const Voxel& v) { return !near_lost.contains(v); });
    }
    return depths;
  }

  const Image& image_;
  double h_;
};

void expect_by_definition(const Image& image, double width_mm) {
  const Smoothing smoothing = smooth(image, width_mm, 2);
  EXPECT_EQ(smoothing.width_mm, width_mm);
  const auto expected = ByDefinition(image).voxel_weights(width_mm);
  std::set<long> different;
  for (const auto& [v, weight] : expected) {
    different.insert(weight);
    // Sums in another order may round to the next 65535th.
    EXPECT_NEAR(smoothing.voxel_weights[place(image, v)], weight, 1) << v[0] << ' ' << v[1] << ' ' << v[2];
  }
  EXPECT_GT(different.size(), 20U);
}

TEST(Smoothing, IsByDefinition) {
  for (const auto& [num_labels, width] :
       {std::pair{2U, 0.6}, {2U, 1.5}, {3U, 1.0}, {3U, 1.5}, {4U, 0.8}, {4U, 3.0}})
    expect_by_definition(random_image(num_labels, {9, 7, 8}, kCubes, num_labels), width);
}

TEST(Smoothing, IsByDefinitionWhereVoxelsAreNoCubes) {
  for (const double width : {0.7, 1.1, 2.0}) {
    expect_by_definition(random_image(21, {8, 9, 7}, {0.8, 1, 1.7}, 3), width);
    expect_by_definition(random_image(22, {9, 6, 8}, {1.2, 2.5, 0.7}, 4), width);
  }
}

// The widths are whole numbers of voxels, which rounding makes slightly larger or smaller.
TEST(Smoothing, IsByDefinitionWhereWidthsAreWholeVoxels) {
  for (const auto& [spacing, width] : {std::pair{0.8, 1.6}, {0.4, 0.8}, {0.9, 2.7}, {0.7, 0.7}, {0.1, 0.3}})
    expect_by_definition(random_image(24, {9, 8, 6}, {spacing, spacing, spacing}, 3), width);
}

TEST(Smoothing, IsByDefinitionInImagesOfManyParts) {
  expect_by_definition(random_image(31, {70, 33, 3}, kCubes, 4), 1);
  expect_by_definition(random_image(32, {3, 40, 66}, {1, 0.9, 1.1}, 3), 0.8);
}

TEST(Smoothing, ThreadsDoNotMatter) {
  const Image image = random_image(4, {70, 40, 37}, kCubes, 4);
  const auto one = smooth(image, 1.5, 1).voxel_weights;
  for (const int threads : {2, 5}) EXPECT_EQ(smooth(image, 1.5, threads).voxel_weights, one);
}

Image smoothed(Image image, double width_mm) {
  image.smoothing = smooth(image, width_mm, 2);
  return image;
}

TEST(Smoothing, CentresOfVoxelsKeepTheirLabels) {
  for (const double width : {0.7, 1.5, 3.0}) {
    const Image image = smoothed(random_image(6, {12, 9, 10}, {1, 0.8, 1.3}, 4), width);
    const LabelFunction function(image);
    for (int k = 0; k < image.size[2]; ++k)
      for (int j = 0; j < image.size[1]; ++j)
        for (int i = 0; i < image.size[0]; ++i)
          EXPECT_EQ(function.label_at({double(i), double(j), double(k)}),
                    image.voxels[place(image, {i, j, k})]);
  }
}

// Returns the share of a box that has the label, at the centers of small cubes.
double share_of(const LabelFunction& function, std::uint32_t label, const Point& low, const Point& high,
                int parts) {
  std::size_t count = 0, all = 0;
  const auto at = [&](std::size_t axis, int i) {
    return low[axis] + (high[axis] - low[axis]) * (i + 0.5) / parts;
  };
  for (int k = 0; k < parts; ++k)
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i < parts; ++i, ++all)
        count += function.label_at({at(0, i), at(1, j), at(2, k)}) == label;
  return static_cast<double>(count) / static_cast<double>(all);
}

TEST(Smoothing, APlaneStaysWhereItIs) {
  const Image image =
      smoothed(image_of({20, 9, 9}, kCubes, [](int i, int, int) { return i < 10 ? 3U : 7U; }), 1.5);
  const LabelFunction function(image);
  EXPECT_NEAR(function.change_after({9, 4, 4}, 0), 0.5, 1e-4);
}

// The interface of a smoothed ball is the sphere, not the stairs of voxels.
TEST(Smoothing, ABallIsRound) {
  constexpr double kRadius = 10, kCenter = 13.2;
  const auto from_center = [](double i, double j, double k) {
    return std::hypot(i - kCenter, j - kCenter, k - kCenter);
  };
  const Image stairs = image_of(
      {28, 28, 28}, kCubes, [&](int i, int j, int k) { return from_center(i, j, k) < kRadius ? 1U : 0U; });
  const auto mean_error = [&](const Image& image) {
    const LabelFunction function(image);
    double sum = 0;
    std::size_t count = 0;
    Voxel v{};
    for (v[2] = 0; v[2] + 1 < 28; ++v[2])
      for (v[1] = 0; v[1] + 1 < 28; ++v[1])
        for (v[0] = 0; v[0] + 1 < 28; ++v[0])
          for (std::size_t axis = 0; axis < 3; ++axis) {
            Voxel next = v;
            ++next[axis];
            if (image.voxels[place(image, v)] == image.voxels[place(image, next)]) continue;
            Point p{double(v[0]), double(v[1]), double(v[2])};
            p[axis] += function.change_after(v, axis);
            sum += std::abs(from_center(p[0], p[1], p[2]) - kRadius);
            ++count;
          }
    return sum / static_cast<double>(count);
  };
  const Image round = smoothed(stairs, 1.5);
  EXPECT_LT(mean_error(round), 0.1);
  EXPECT_LT(mean_error(round), 0.5 * mean_error(stairs));
  const double volume =
      28 * 28 * 28 * share_of(LabelFunction(round), 1, {-0.5, -0.5, -0.5}, {27.5, 27.5, 27.5}, 140);
  const auto true_volume = 4 * std::numbers::pi / 3 * kRadius * kRadius * kRadius;
  EXPECT_NEAR(volume, true_volume, 0.005 * true_volume);
}

// A sheet stays as thick as its voxels and a rod keeps their section, whatever the width.
TEST(Smoothing, ThinPartsKeepTheirVolume) {
  for (const double width : {0.8, 1.5, 3.0})
    for (const int thickness : {1, 2, 3, 4}) {
      const auto is_within = [&](int i) { return i >= 9 && i < 9 + thickness; };
      const Image sheet = smoothed(
          image_of({20, 20, 20}, kCubes, [&](int i, int, int) { return is_within(i) ? 1U : 0U; }), width);
      const Image stairs_of_rod = image_of(
          {20, 20, 20}, kCubes, [&](int i, int j, int) { return is_within(i) && is_within(j) ? 1U : 0U; });
      const Image rod = smoothed(stairs_of_rod, width);
      const Point low{5.03, 5.07, 9}, high{15.03, 15.07, 10};
      const auto volume = [&](const Image& image) {
        return 100 * share_of(LabelFunction(image), 1, low, high, 70);
      };
      EXPECT_NEAR(volume(sheet), 10 * thickness, 0.4) << "width " << width;
      // The label function rounds the edges of a rod that is not smoothed, too.
      EXPECT_NEAR(volume(rod) / volume(stairs_of_rod), 1, thickness > 1 ? 0.05 : 0.12) << "width " << width;
    }
}

TEST(Smoothing, BadWidthsAreRefused) {
  const Image image = image_of({9, 9, 4}, {1, 0.5, 0.8}, [](int i, int, int) { return i < 4 ? 1U : 0U; });
  for (const double width : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity(), 3.2, 5.0}) {
    try {
      smooth(image, width, 1);
      ADD_FAILURE() << width << " was taken";
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with("made.nii: ")) << message;
      EXPECT_NE(message.find("at most 4 mm"), std::string::npos) << message;
      EXPECT_NE(message.find("less than 3.2 mm"), std::string::npos) << message;
    }
  }
  EXPECT_EQ(smooth(image, 3.1, 1).voxel_weights.size(), image.voxels.size());
  const Image long_image =
      image_of({30, 30, 30}, {1, 0.5, 0.8}, [](int i, int, int) { return i < 4 ? 1U : 0U; });
  EXPECT_THROW(smooth(long_image, 4.01, 1), InputError);
  EXPECT_EQ(smooth(long_image, 4, 1).width_mm, 4);
}

}  // namespace
}  // namespace podm::verify
