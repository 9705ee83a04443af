#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "isosurface/isosurface.h"
#include "isosurface/tests/isosurface_reference.h"
#include "podm/errors.h"
#include "smoothing/smooth_interfaces.h"

namespace podm::test {
namespace {

// The definition in smooth_interfaces.h, implemented with sums over all voxels.
class Definition {
 public:
  Definition(const LabelImage& image, double width_mm)
      : image_(image),
        width_mm_(width_mm),
        side_mm_(std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2])) {}

  std::vector<std::uint16_t> weights() const {
    const std::vector<double> distances = distances_mm();
    const double unit = std::max(1.1 * width_mm_, side_mm_ / 2) / 65535;
    std::vector<std::uint16_t> weights;
    for (const double d : distances)
      weights.push_back(std::isnan(d) ? 0
                                      : static_cast<std::uint16_t>(std::min(
                                            std::round(std::max(d, side_mm_ / 20) / unit), 65535.0)));
    return with_volumes_kept(with_volumes_kept(weights, unit), unit);
  }

 private:
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int k = 0; k < image_.size[2]; ++k)
      for (int j = 0; j < image_.size[1]; ++j)
        for (int i = 0; i < image_.size[0]; ++i) visit(Voxel{i, j, k}, image_.index(i, j, k));
  }
  LabelIndex label(const Voxel& v) const {
    const auto is_in = [&](int at, std::size_t a) { return at >= 0 && at < image_.size[a]; };
    return is_in(v.i, 0) && is_in(v.j, 1) && is_in(v.k, 2) ? image_.voxels[image_.index(v.i, v.j, v.k)]
                                                           : kBackground;
  }

  // The weights of all voxels along an axis in the blur at one of them.
  std::vector<double> taps(double width_mm, std::size_t a, int at) const {
    const double s = width_mm / image_.spacing[a];
    const int reach = static_cast<int>(std::ceil(3 * s - 1e-5));
    std::vector<double> of_voxel(static_cast<std::size_t>(image_.size[a]));
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) sum += std::exp(-i * i / (2 * s * s));
    for (int i = -reach; i <= reach; ++i)
      of_voxel[static_cast<std::size_t>(std::clamp(at + i, 0, image_.size[a] - 1))] +=
          std::exp(-i * i / (2 * s * s)) / sum;
    return of_voxel;
  }
  std::vector<double> blurred(double width_mm, const Voxel& v) const {
    const auto x = taps(width_mm, 0, v.i), y = taps(width_mm, 1, v.j), z = taps(width_mm, 2, v.k);
    std::vector<double> weights(image_.labels.size());
    for_each([&](const Voxel& u, std::size_t at) {
      weights[image_.voxels[at]] += x[static_cast<std::size_t>(u.i)] * y[static_cast<std::size_t>(u.j)] *
                                    z[static_cast<std::size_t>(u.k)];
    });
    return weights;
  }
  double distance_mm(double width_mm, const Voxel& v) const {
    const std::vector<double> narrow = blurred(width_mm, v), wide = blurred(2 * width_mm, v);
    double own = 0, other = 0;
    for (std::size_t l = 0; l < narrow.size(); ++l) {
      const double weight = 2 * narrow[l] - wide[l];
      if (l == label(v))
        own = weight;
      else
        other = std::max(other, weight);
    }
    return width_mm * std::sqrt(2 * std::numbers::pi) / 3 * (own - other);
  }

  bool is_beside_another(const Voxel& v) const {
    for (int n = 0; n < 27; ++n)
      if (label({v.i + n % 3 - 1, v.j + n / 3 % 3 - 1, v.k + n / 9 - 1}) != label(v)) return true;
    return false;
  }

  // NaN where the weight is unset.
  std::vector<double> distances_mm() const {
    std::vector<double> distances(image_.num_voxels(), std::nan(""));
    std::vector<Voxel> left;
    for_each([&](const Voxel& v, std::size_t) {
      if (is_beside_another(v)) left.push_back(v);
    });
    for (double width = width_mm_; !left.empty(); width /= 2) {
      std::vector<Voxel> lost, next;
      for (const Voxel& v : left) {
        double& d = distances[image_.index(v.i, v.j, v.k)];
        d = width < (1 - 1e-5) * side_mm_ / 2 ? side_mm_ / 2 : distance_mm(width, v);
        if (d < -side_mm_ / 4) lost.push_back(v);
      }
      const auto is_near = [&](int x, int y, std::size_t a) {
        return std::abs(x - y) <= std::ceil(2 * width / image_.spacing[a] - 1e-5);
      };
      std::copy_if(left.begin(), left.end(), std::back_inserter(next), [&](const Voxel& v) {
        return std::any_of(lost.begin(), lost.end(), [&](const Voxel& u) {
          return is_near(u.i, v.i, 0) && is_near(u.j, v.j, 1) && is_near(u.k, v.k, 2);
        });
      });
      left = next;
    }
    return distances;
  }

  // The mean outward shift of the interface of v's label over its faces nearby, in units of the weights.
  double shift(const Voxel& v, const std::vector<std::uint16_t>& weights) const {
    const double shortest = *std::min_element(image_.spacing.begin(), image_.spacing.end());
    const std::array<int, 3> place{v.i, v.j, v.k};
    double areas = 0, leads = 0;
    for_each([&](const Voxel& u, std::size_t at) {
      const std::array<int, 3> near{u.i, u.j, u.k};
      for (std::size_t a = 0; a < 3; ++a)
        if (std::abs(near[a] - place[a]) > std::ceil(2 * width_mm_ / image_.spacing[a] - 1e-5)) return;
      if (label(u) != label(v)) return;
      for (std::size_t a = 0; a < 3; ++a)
        for (const int step : {-1, 1}) {
          std::array<int, 3> beyond = near;
          beyond[a] += step;
          if (beyond[a] < 0 || beyond[a] >= image_.size[a]) continue;
          const std::size_t other = image_.index(beyond[0], beyond[1], beyond[2]);
          if (image_.voxels[other] == image_.voxels[at]) continue;
          const double area = std::max(1.0, std::round(256 * shortest / image_.spacing[a]));
          areas += area;
          leads += area * (weights[at] - weights[other]);
        }
    });
    return areas > 0 ? leads / areas / 2 : 0;
  }

  std::vector<std::uint16_t> with_volumes_kept(const std::vector<std::uint16_t>& weights, double unit) const {
    std::vector<std::uint16_t> kept = weights;
    const double least = std::round(side_mm_ / 20 / unit);
    for_each([&](const Voxel& v, std::size_t at) {
      if (weights[at] > 0)
        kept[at] = static_cast<std::uint16_t>(
            std::clamp(std::round(weights[at] - shift(v, weights)), least, 65535.0));
    });
    return kept;
  }

  const LabelImage& image_;
  double width_mm_, side_mm_;
};

LabelImage labelled(LabelImage image) {
  image.labels.resize(1u + *std::max_element(image.voxels.begin(), image.voxels.end()));
  return image;
}

std::vector<std::uint16_t> all_weights(const LabelImage& image, double width_mm, int threads) {
  const auto smoothed = smooth_interfaces(image, width_mm, threads);
  std::vector<std::uint16_t> weights;
  for (std::size_t v = 0; v < image.num_voxels(); ++v) weights.push_back(smoothed.weights->at(v));
  return weights;
}

// Sums that are rounded differently may give weights that differ by 1.
TEST(SmoothInterfaces, HaveTheWeightsOfTheDefinition) {
  Random random(31);
  for (const unsigned num_labels : {2u, 4u}) {
    for (const double coherence : {0.5, 0.9, 0.97}) {
      const LabelImage image =
          labelled(random_image(random, {19, 17, 5}, {1, 0.8, 1.9}, num_labels, coherence));
      for (const double width : {0.3, 0.9, 2.0}) {
        const auto expected = Definition(image, width).weights(), found = all_weights(image, width, 1);
        for (std::size_t v = 0; v < expected.size(); ++v) ASSERT_NEAR(found[v], expected[v], 1);
      }
    }
  }
}

// Widths of whole numbers of voxels, which rounding makes slightly larger or smaller.
TEST(SmoothInterfaces, HaveTheWeightsOfTheDefinitionWhereWidthsAreWholeVoxels) {
  Random random(35);
  for (const auto& [spacing, width] : {std::pair{0.8, 1.6}, {0.4, 0.8}, {0.9, 2.7}, {0.7, 0.7}, {0.1, 0.3}}) {
    const LabelImage image = labelled(random_image(random, {15, 13, 6}, {spacing, spacing, spacing}, 3, 0.9));
    const auto expected = Definition(image, width).weights(), found = all_weights(image, width, 1);
    for (std::size_t v = 0; v < expected.size(); ++v) ASSERT_NEAR(found[v], expected[v], 1) << spacing;
  }
}

TEST(SmoothInterfaces, DoNotDependOnThreads) {
  Random random(32);
  const LabelImage image = labelled(random_image(random, {45, 38, 20}, {0.7, 0.7, 1}, 5, 0.95));
  EXPECT_EQ(all_weights(image, 1.3, 1), all_weights(image, 1.3, 3));
}

// Voxel centers, and the segments between neighbors of one label, keep their label. Components by faces
// therefore stay as they are.
TEST(SmoothInterfaces, KeepVoxelsAndTheWaysBetweenThem) {
  Random random(33);
  for (const double width : {0.7, 2.5}) {
    const LabelImage image = labelled(random_image(random, {24, 21, 19}, {1, 1, 1}, 4, 0.9));
    const Isosurface isosurface(image, 1, smooth_interfaces(image, width, 1).weights);
    for (int n = 0; n < 20'000; ++n) {
      const Voxel v{static_cast<int>(random() % 23), static_cast<int>(random() % 20),
                    static_cast<int>(random() % 18)};
      const auto axis = random() % 3;
      const Voxel u{v.i + (axis == 0), v.j + (axis == 1), v.k + (axis == 2)};
      const LabelIndex label = image.voxels[image.index(v.i, v.j, v.k)];
      ASSERT_EQ(isosurface.label_at(center(v)), label);
      if (image.voxels[image.index(u.i, u.j, u.k)] != label) continue;
      ASSERT_EQ(isosurface.label_at(center(v) + uniform(random, 0, 1) * (center(u) - center(v))), label);
    }
  }
}

struct Shape {
  LabelImage image;
  double volume_mm3;
  std::function<double(const Point&)> depth;  // distance to the outside, positive inside
};

template <class Depth>
Shape shape(std::array<int, 3> size, double spacing, double volume_mm3, const Depth& depth) {
  LabelImage image = empty_image(size, {spacing, spacing, spacing});
  image.labels.resize(2);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        image.voxels[image.index(i, j, k)] = depth(spacing * center({i, j, k})) > 0;
  return {image, volume_mm3, depth};
}

std::vector<Shape> round_shapes() {
  const Point middle{15.3, 16.1, 15.7};
  const double pi = std::numbers::pi;
  return {
      shape({64, 64, 64}, 0.5, 4.0 / 3 * pi * 1000, [=](const Point& p) { return 10 - distance(p, middle); }),
      shape({64, 64, 64}, 0.5, 2 * pi * pi * 9 * 16, [=](const Point& p) {
        const Vector d = p - middle;
        return 4 - std::hypot(std::hypot(d.x, d.y) - 9, d.z);
      })};
}

Vector gradient(const std::function<double(const Point&)>& f, const Point& p) {
  constexpr double kStep = 1e-5;
  const auto along = [&](const Vector& d) { return (f(p + kStep * d) - f(p - kStep * d)) / (2 * kStep); };
  return {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
}

// The root mean square angle, in degrees, between the normals of facets and those of the shape. The facets
// have corners on the isosurface, two voxels apart.
double normal_error_deg(const Shape& shape, const Isosurface& isosurface) {
  Random random(34);
  double sum = 0;
  int count = 0;
  while (count < 2000) {
    Point p = random_point(random, shape.image, 0);
    if (std::fabs(shape.depth(p)) > 1) continue;
    p = p - shape.depth(p) * gradient(shape.depth, p);
    const Vector normal = gradient(shape.depth, p);
    Vector across = cross(normal, {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
    across = (1 / std::sqrt(squared_length(across))) * across;
    const Vector other = cross(normal, across);
    std::array<Point, 3> corners;
    for (int c = 0; c < 3; ++c) {
      const double angle = 2 * std::numbers::pi / 3 * c, reach = 2 * shape.image.spacing[0] / std::sqrt(3);
      const Point q = p + reach * (std::cos(angle) * across + std::sin(angle) * other);
      const Vector down = 3 * shape.image.spacing[0] * gradient(shape.depth, q);
      corners[static_cast<std::size_t>(c)] = isosurface.segment_intersection(q - down, q + down).value();
    }
    const Vector facet = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const Vector truth = gradient(shape.depth, (1.0 / 3) * (corners[0] + corners[1] + corners[2]));
    const double cosine =
        std::fabs(dot(facet, truth)) / std::sqrt(squared_length(facet) * squared_length(truth));
    const double angle = std::acos(std::min(cosine, 1.0)) * 180 / std::numbers::pi;
    sum += angle * angle;
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(SmoothInterfaces, HalveErrorsOfNormalsAndKeepVolumes) {
  for (const Shape& shape : round_shapes()) {
    const double stairs_deg = normal_error_deg(shape, Isosurface(shape.image, 1));
    for (const double voxels : {1.0, 1.5, 2.0}) {
      const auto smoothed = smooth_interfaces(shape.image, voxels * shape.image.spacing[0], 1);
      const Isosurface isosurface(shape.image, 1, smoothed.weights);
      EXPECT_LE(normal_error_deg(shape, isosurface), (voxels > 1 ? 0.4 : 0.55) * stairs_deg) << voxels;
      const double volume = volumes_mm3(shape.image, *smoothed.weights, 1)[1];
      EXPECT_NEAR(volume / shape.volume_mm3, 1, 0.005) << voxels;
      EXPECT_TRUE(smoothed.labels_lost.empty());
    }
  }
}

double volume_mm3(const LabelImage& image, double width_mm) {
  return volumes_mm3(image, *smooth_interfaces(image, width_mm, 1).weights, 1)[1];
}

double volume_of_stairs_mm3(const LabelImage& image) {
  VoxelWeights equal(image.size);
  for (std::size_t v = 0; v < image.num_voxels(); ++v) equal.at(v) = VoxelWeights::kMost;
  return volumes_mm3(image, equal, 1)[1];
}

enum class Part { kSlab, kSquareRod, kRoundRod, kTilted };

bool is_in_part(Part part, double thickness, const Point& p) {
  const double u = p.x - 10.5, v = p.y - 10.5;
  switch (part) {
    case Part::kSlab:
      return u > 0 && u < thickness;
    case Part::kSquareRod:
      return u > 0 && u < thickness && v > 0 && v < thickness;
    case Part::kRoundRod:
      return std::hypot(u - 1.2, v - 1.3) < thickness / 2;
    case Part::kTilted:
      return std::fabs(0.89 * (p.x - 12) + 0.4 * (p.y - 12) + 0.2 * (p.z - 12)) < thickness / 2;
  }
  return false;
}

// An image of one label, 0 or 1, that contains a part of the other one. The part has label `label` and
// continues beyond the grid.
LabelImage image_with(Part part, double thickness, LabelIndex label) {
  LabelImage image = empty_image({24, 24, 24}, {1, 1, 1});
  image.labels.resize(2);
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i)
        image.voxels[image.index(i, j, k)] =
            (thickness > 0 && is_in_part(part, thickness, center({i, j, k}))) == (label == 1);
  return image;
}

// Parts of the label and gaps in it, thinner and thicker than the blur, have the volume that they have with
// stairs.
TEST(SmoothInterfaces, KeepThinPartsByVolume) {
  const LabelImage full = image_with(Part::kSlab, 0, 0);
  for (const Part part : {Part::kSlab, Part::kSquareRod, Part::kRoundRod, Part::kTilted}) {
    for (const double thickness : {1., 2., 3., 4., 5., 6.}) {
      if (part == Part::kRoundRod && thickness < 2) continue;  // has no voxel, or one
      for (const LabelIndex label : {LabelIndex{0}, LabelIndex{1}}) {
        const LabelImage image = image_with(part, thickness, label);
        // The volume of a gap is that of the full object, which is rounded at the edges of the grid, minus
        // that of the object with the gap.
        const auto of_part = [&](const auto& volume) {
          return label == 1 ? volume(image) : volume(full) - volume(image);
        };
        const double stairs = of_part(volume_of_stairs_mm3);
        for (const double width : {1.0, 1.5, 2.0, 3.0}) {
          const double smoothed = of_part([&](const LabelImage& of) { return volume_mm3(of, width); });
          const bool is_thin_rod = part != Part::kSlab && part != Part::kTilted && thickness <= 2;
          const double allowed = is_thin_rod ? 0.12 : 0.04;
          EXPECT_NEAR(smoothed / stairs, 1, allowed)
              << static_cast<int>(part) << ' ' << thickness << ' ' << width << ' ' << label;
        }
      }
    }
  }
}

// Rods of voxels that are 3 to 3.6 times as long along one axis across the rod as along the other.
TEST(SmoothInterfaces, KeepLessOfThinRodsWhereVoxelsAreNoCubes) {
  for (const std::array<double, 3>& spacing : {std::array{1.0, 1.0, 3.0}, std::array{0.7, 0.7, 2.5}})
    for (const auto& [voxels, most_lost] : {std::pair{1, 0.40}, {2, 0.15}, {3, 0.08}, {5, 0.04}}) {
      LabelImage image = empty_image({24, 24, 16}, spacing);
      image.labels.resize(2);
      for (int k = 5; k < 5 + voxels; ++k)
        for (int j = 9; j < 9 + voxels; ++j)
          for (int i = 0; i < image.size[0]; ++i) image.voxels[image.index(i, j, k)] = 1;
      const double stairs = volume_of_stairs_mm3(image);
      for (const double width : {1.0, 1.5, 2.0}) {
        const double kept = volume_mm3(image, width * spacing[0]) / stairs;
        EXPECT_GT(kept, 1 - most_lost) << voxels << ' ' << width;
        EXPECT_LT(kept, 1.04) << voxels << ' ' << width;
      }
    }
}

TEST(SmoothInterfaces, NameLabelsThatTheWholeWidthWouldLose) {
  LabelImage image = empty_image({24, 24, 24}, {1, 1, 1});
  image.labels.resize(3);
  for (int k = 4; k < 20; ++k)
    for (int j = 4; j < 20; ++j)
      for (int i = 4; i < 20; ++i) image.voxels[image.index(i, j, k)] = k == 12 ? 2 : 1;
  EXPECT_EQ(smooth_interfaces(image, 2, 1).labels_lost, std::vector<LabelIndex>{2});
  EXPECT_TRUE(smooth_interfaces(image, 0.4, 1).labels_lost.empty());
}

TEST(SmoothInterfaces, RefuseWidthsThatMakeNoSense) {
  const LabelImage image = labelled(empty_image({6, 30, 30}, {0.5, 1, 1}));
  for (const double width : {0.0, -1.0, std::nan(""), 3.0, 4.1}) {
    EXPECT_THROW(smooth_interfaces(image, width, 1), InputError) << width;
  }
  EXPECT_NO_THROW(smooth_interfaces(image, 2.9, 1));
}

}  // namespace
}  // namespace podm::test
