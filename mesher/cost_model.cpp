#include "cost_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace podm {

namespace {

// Fitted to a few runs, right to about 30 %: cells = kVolumeCells V / r^3 + kSurfaceCells A / delta^2, with A
// counted in voxel faces.
constexpr double kVolumeCells = 4.5;
constexpr double kSurfaceCells = 4.0;
constexpr double kMaxDeltaVoxels = 2;
constexpr double kBytesPerCell = 110;
constexpr double kBytesPerVoxel = 6;

struct Geometry {
  double volume_mm3 = 0, area_mm2 = 0;
  std::vector<double> volume_of_label_mm3;
};

Geometry measure(const LabelImage& image) {
  const auto [sx, sy, sz] = image.spacing;
  const std::array<double, 3> face_mm2{sy * sz, sx * sz, sx * sy};
  const std::array<std::size_t, 3> stride{
      1, static_cast<std::size_t>(image.size[0]),
      static_cast<std::size_t>(image.size[0]) * static_cast<std::size_t>(image.size[1])};
  Geometry g;
  g.volume_of_label_mm3.resize(image.labels.size());
  for (int k = 0; k < image.size[2]; ++k) {
    for (int j = 0; j < image.size[1]; ++j) {
      for (int i = 0; i < image.size[0]; ++i) {
        const std::size_t at = image.index(i, j, k);
        const LabelIndex label = image.voxels[at];
        if (label != kBackground) g.volume_of_label_mm3[label] += sx * sy * sz;
        const std::array<int, 3> position{i, j, k};
        for (unsigned axis = 0; axis < 3; ++axis) {
          const bool is_last = position[axis] + 1 == image.size[axis];
          const LabelIndex next = is_last ? kBackground : image.voxels[at + stride[axis]];
          g.area_mm2 += (next != label) * face_mm2[axis];
          if (position[axis] == 0) g.area_mm2 += (label != kBackground) * face_mm2[axis];
        }
      }
    }
  }
  for (const double v : g.volume_of_label_mm3) g.volume_mm3 += v;
  return g;
}

double cells_at(const LabelImage& image, const Geometry& g, const MeshingOptions& options) {
  double cells = 0, smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < image.labels.size(); ++i) {
    const auto own = options.radius_of_mm.find(image.labels[i].value);
    const double radius = own != options.radius_of_mm.end() ? own->second : options.radius_mm;
    if (radius <= 0) continue;
    cells += kVolumeCells * g.volume_of_label_mm3[i] / (radius * radius * radius);
    smallest = std::min(smallest, radius);
  }
  const double delta =
      options.delta_mm > 0 ? options.delta_mm : default_delta_mm(image, std::isinf(smallest) ? 0 : smallest);
  return cells + kSurfaceCells * g.area_mm2 / (delta * delta);
}

}  // namespace

double default_delta_mm(const LabelImage& image, double radius_mm) {
  const double voxel = std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2]);
  return radius_mm > 0 ? std::min(kMaxDeltaVoxels * voxel, radius_mm / 2) : voxel;
}

Estimate estimate(const LabelImage& image, const MeshingOptions& options) {
  const double cells = options.target_elements > 0 ? static_cast<double>(options.target_elements)
                                                   : cells_at(image, measure(image), options);
  return {cells, cells * kBytesPerCell + static_cast<double>(image.num_voxels()) * kBytesPerVoxel};
}

double radius_for_cells(const LabelImage& image, double cells) {
  const Geometry g = measure(image);
  double low = 1e-9, high = 1e9;  // mm; the number of cells falls with the radius
  while (high / low > 1.001) {
    const double radius = std::sqrt(low * high), delta = radius / 2;
    const double expected = kVolumeCells * g.volume_mm3 / (radius * radius * radius) +
                            kSurfaceCells * g.area_mm2 / (delta * delta);
    (expected > cells ? low : high) = radius;
  }
  return high;
}

Box foreground_bounds(const LabelImage& image) {
  std::array<int, 3> low = image.size, high{-1, -1, -1};
  for (int k = 0; k < image.size[2]; ++k) {
    for (int j = 0; j < image.size[1]; ++j) {
      for (int i = 0; i < image.size[0]; ++i) {
        if (image.voxels[image.index(i, j, k)] == kBackground) continue;
        const std::array<int, 3> at{i, j, k};
        for (unsigned axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], at[axis]);
          high[axis] = std::max(high[axis], at[axis]);
        }
      }
    }
  }
  if (high[0] < 0) throw InputError("the image has no foreground");
  const auto& s = image.spacing;
  return {{(low[0] - 1) * s[0], (low[1] - 1) * s[1], (low[2] - 1) * s[2]},
          {(high[0] + 1) * s[0], (high[1] + 1) * s[1], (high[2] + 1) * s[2]}};
}

}  // namespace podm
