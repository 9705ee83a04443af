#include "sizing/default_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace podm {

namespace {

constexpr double kMaxDeltaVoxels = 2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double default_delta_mm(const LabelImage& image, double radius_mm) {
  const double voxel = std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2]);
  return radius_mm > 0 ? std::min(kMaxDeltaVoxels * voxel, radius_mm / 2) : voxel;
}

double radius_mm_of(const SizeOptions& sizes, const Label& label) {
  const auto own = sizes.radius_of_mm.find(label.value);
  return own != sizes.radius_of_mm.end() ? own->second : sizes.radius_mm;
}

std::vector<double> radii_of_labels_mm(const LabelImage& image, const SizeOptions& sizes) {
  std::vector<double> radii(image.labels.size(), kInfinity);
  for (std::size_t i = 1; i < radii.size(); ++i)
    if (const double radius = radius_mm_of(sizes, image.labels[i]); radius > 0) radii[i] = radius;
  return radii;
}

double smallest_radius_mm(const SizeOptions& sizes) {
  double smallest = sizes.radius_mm > 0 ? sizes.radius_mm : kInfinity;
  for (const auto& [value, radius] : sizes.radius_of_mm) smallest = std::min(smallest, radius);
  return std::isinf(smallest) ? 0 : smallest;
}

double delta_mm_for(const LabelImage& image, const SizeOptions& sizes, const SizeCensus* census) {
  if (sizes.delta_mm > 0) return sizes.delta_mm;
  const double of_labels = smallest_radius_mm(sizes);
  if (census == nullptr || std::isinf(census->largest_mm())) return default_delta_mm(image, of_labels);
  return default_delta_mm(image,
                          of_labels > 0 ? std::min(of_labels, census->largest_mm()) : census->largest_mm());
}

SizeField size_field(const LabelImage& image, const SizeOptions& sizes,
                     std::shared_ptr<const SizeGrid> grid) {
  return SizeField(radii_of_labels_mm(image, sizes), std::move(grid));
}

}  // namespace podm
