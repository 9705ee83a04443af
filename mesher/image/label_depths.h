// Depths of voxels in their labels, and unions of balls in labels.
//
// The depth of a voxel is the distance from its center to the box of the nearest voxel of another label.
// Everything beyond the grid is background.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "podm/label_image.h"
#include "runtime/parallel_for.h"

namespace podm {

/// The labels whose voxels have depths and balls.
enum class DepthsOf { kForeground, kAllLabels };

/// A number for each voxel. It is updated line by line, along one axis after another.
class VoxelField {
 public:
  VoxelField(const LabelImage& image, float value, int threads, DepthsOf of = DepthsOf::kForeground)
      : image_(image), of_(of), threads_(num_threads(threads)), values_(image.voxels.size(), value) {}

  float& operator[](std::size_t voxel) { return values_[voxel]; }
  float operator[](std::size_t voxel) const { return values_[voxel]; }

  /// Sets each voxel i of each line, along x, then y, then z, to change(labels, before, i, spacing in mm).
  /// The voxels of labels without depths stay.
  template <class Change>
  void sweep(const Change& change) {
    for (std::size_t axis = 0; axis < 3; ++axis) sweep(axis, change);
  }

 private:
  bool has_depth(LabelIndex label) const { return label != kBackground || of_ == DepthsOf::kAllLabels; }
  template <class Change>
  void sweep(std::size_t axis, const Change& change) {
    const auto length = static_cast<std::size_t>(image_.size[axis]);
    const std::size_t across = axis == 0 ? 1 : 0, along = axis == 2 ? 1 : 2;
    const std::array<std::size_t, 3> stride{1, image_.index(0, 1, 0), image_.index(0, 0, 1)};
    const auto sheets = static_cast<std::size_t>(image_.size[along]);
    parallel_for(sheets, threads_, [&](std::size_t sheet, std::size_t) {
      std::vector<LabelIndex> labels(length);
      std::vector<float> before(length);
      for (std::size_t line = 0; line < static_cast<std::size_t>(image_.size[across]); ++line) {
        const std::size_t begin = sheet * stride[along] + line * stride[across];
        bool is_empty = true;
        for (std::size_t i = 0; i < length; ++i) {
          labels[i] = image_.voxels[begin + i * stride[axis]];
          before[i] = values_[begin + i * stride[axis]];
          is_empty = is_empty && !has_depth(labels[i]);
        }
        if (is_empty) continue;
        for (std::size_t i = 0; i < length; ++i)
          if (has_depth(labels[i]))
            values_[begin + i * stride[axis]] = change(labels, before, i, image_.spacing[axis]);
      }
    });
  }

  const LabelImage& image_;
  DepthsOf of_;
  std::size_t threads_;
  std::vector<float> values_;
};

/// Finds squared depths, mm^2, up to that of `most_mm`, which all voxels have before.
void find_label_depths(VoxelField& depths, double most_mm);

/// The input is minus the squared radius of the ball at each voxel, or infinity if there is none. The output
/// is positive outside all balls. No radius exceeds `most_mm`. A ball stays within its label, and so does the
/// path along the axes from its center.
void unite_balls(VoxelField& balls, double most_mm);

}  // namespace podm
