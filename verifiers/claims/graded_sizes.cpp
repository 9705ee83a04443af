#include "claims/graded_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "claims/size_field.h"
#include "image/image_frame.h"
#include "parallel.h"

namespace podm::verify {

namespace {

constexpr float kNoBound = std::numeric_limits<float>::infinity();
constexpr double kRoundingOfFloats = 0x1p-24;
constexpr double kRounding = 1e-6;  // of voxel coordinates
constexpr std::size_t kMostNodes = std::size_t{1} << 26;

double diagonal_mm(const Image& image) {
  return std::hypot(image.spacing[0], image.spacing[1], image.spacing[2]);
}

std::array<double, 12> rounded(const std::array<mpq_class, 12>& exact) {
  std::array<double, 12> m;
  std::transform(exact.begin(), exact.end(), m.begin(), [](const mpq_class& x) { return x.get_d(); });
  return m;
}

Point mapped(const Point& p, const std::array<double, 12>& m) {
  Point q;
  for (std::size_t row = 0; row < 3; ++row)
    q[row] = m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
  return q;
}

// Bounds at the centers of an image's voxels.
class VoxelBounds {
 public:
  VoxelBounds(const Image& image, const Options& options)
      : image_(image),
        options_(options),
        frame_(image, Space::kRas),
        radius_mm_(image.voxels.size(), kNoBound) {}

  void bound_by_labels() {
    for (std::size_t i = 0; i < image_.voxels.size(); ++i) {
      const std::uint32_t label = image_.voxels[i];
      if (label == 0) continue;
      if (i > 0 && label == image_.voxels[i - 1]) {
        radius_mm_[i] = radius_mm_[i - 1];
      } else if (const auto radius = options_.radius_of_label(label)) {
        radius_mm_[i] = static_cast<float>(*radius);
      }
    }
  }

  void bound_by_size_image(const SizeImage& sizes) {
    const SizeField field(sizes, options_.size_factor, Space::kRas);
    const std::array<double, 12> to_sizes = rounded(exact_mesh_to_voxels(sizes.voxel_to_ras, Space::kRas));
    parallel_ranges(
        radius_mm_.size(), options_.threads, [&](std::size_t begin, std::size_t end, std::size_t) {
          for (std::size_t i = begin; i < end; ++i)
            lower(i, field.bound_at(mapped(frame_.voxels_to_world(place(i, image_.size)), to_sizes)));
        });
    for (std::size_t i = 0; i < sizes.radius_mm.size(); ++i)
      if (sizes.radius_mm[i] > 0)
        bound_at_nearest(mapped(place(i, sizes.size), sizes.voxel_to_ras), sizes.radius_mm[i]);
  }

  std::vector<float> take() && { return std::move(radius_mm_); }

 private:
  static Point place(std::size_t i, const std::array<int, 3>& size) {
    const auto nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]);
    return {static_cast<double>(i % nx), static_cast<double>(i / nx % ny), static_cast<double>(i / nx / ny)};
  }
  void lower(std::size_t i, double radius_mm) {
    radius_mm_[i] = std::min(radius_mm_[i], static_cast<float>(radius_mm));
  }
  // Applies a bound of the size image, at a place in the image, to the nearest voxel. At a tie, or at the
  // border, another program may take another voxel, or none.
  void bound_at_nearest(const Point& p, double radius) {
    const Point voxel = frame_.world_to_voxels(p);
    std::size_t number = 0;
    double squared = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      if (!(voxel[axis] > -0.5 + kRounding && voxel[axis] < image_.size[axis] - 0.5 - kRounding)) return;
      const double nearest = std::round(voxel[axis]);
      const double along = (voxel[axis] - nearest) * image_.spacing[axis];
      squared += along * along;
      number = number * static_cast<std::size_t>(image_.size[axis]) + static_cast<std::size_t>(nearest);
    }
    lower(number, options_.size_factor * radius + 3 * *options_.grade * std::sqrt(squared));
  }

  const Image& image_;
  const Options& options_;
  const ImageFrame frame_;
  std::vector<float> radius_mm_;
};

std::vector<float> voxel_bounds(const Image& image, const SizeImage* sizes, const Options& options) {
  VoxelBounds bounds(image, options);
  bounds.bound_by_labels();
  if (sizes != nullptr) bounds.bound_by_size_image(*sizes);
  return std::move(bounds).take();
}

}  // namespace

int stride_of_nodes(const std::array<int, 3>& size) {
  for (int stride = 1;; ++stride) {
    std::size_t num_nodes = 1;
    for (const int voxels : size)
      num_nodes *= static_cast<std::size_t>((voxels - 1 + stride / 2) / stride + 1);
    if (num_nodes <= kMostNodes) return stride;
  }
}

GradedSizes::GradedSizes(const Image& image, const SizeImage* sizes, const std::vector<InterfaceFaces>& near,
                         const Options& options)
    : slope_(*options.grade),
      near_(near),
      voxels_(image.size, image.spacing, slope_, voxel_bounds(image, sizes, options)),
      rounding_(kRoundingOfFloats * (*std::max_element(image.size.begin(), image.size.end()) + 8)) {
  const int stride = stride_of_nodes(image.size);
  const double of_growth_mm = slope_ * diagonal_mm(image);
  slack_of_voxels_mm_ = of_growth_mm * (2 * (stride / 2) + 0.5 * stride);
  slack_of_interfaces_mm_ = slack_of_voxels_mm_ + of_growth_mm;
}

double GradedSizes::bound_of_voxels(const Point& voxel, double limit_mm, double enough_mm) const {
  const auto without_slack = [&](double radius) { return (radius - slack_of_voxels_mm_) / (1 + rounding_); };
  const double limit = without_slack(limit_mm);
  const double found = voxels_.least_at(voxel, limit, without_slack(enough_mm));
  return found < limit ? found * (1 + rounding_) + slack_of_voxels_mm_ : limit_mm;
}

double GradedSizes::bound_of_interface(const InterfaceFaces& faces, const Point& voxel,
                                       double limit_mm) const {
  const double radius_mm = faces.near().radius_mm, width_mm = faces.near().width_mm;
  const double slack_mm = slack_of_interfaces_mm_ + rounding_ * slope_ * width_mm;
  const double room_mm = (limit_mm - slack_mm) / (1 + rounding_) - radius_mm;
  if (room_mm <= 0) return limit_mm;
  const double reach_mm = width_mm + room_mm / slope_;
  const double distance_mm = faces.distance_mm(voxel, reach_mm);
  if (distance_mm >= reach_mm) return limit_mm;
  return (radius_mm + slope_ * std::max(0.0, distance_mm - width_mm)) * (1 + rounding_) + slack_mm;
}

double GradedSizes::bound_at(const Point& voxel, double limit_mm) const {
  double least_mm = bound_of_voxels(voxel, limit_mm, 0);
  for (const InterfaceFaces& faces : near_) least_mm = bound_of_interface(faces, voxel, least_mm);
  return least_mm;
}

bool GradedSizes::is_exceeded_at(const Point& voxel, double radius_mm) const {
  return bound_of_voxels(voxel, radius_mm, radius_mm) < radius_mm ||
         std::any_of(near_.begin(), near_.end(), [&](const InterfaceFaces& faces) {
           return bound_of_interface(faces, voxel, radius_mm) < radius_mm;
         });
}

}  // namespace podm::verify
