#include "image/label_blur.h"

#include <cmath>
#include <map>

namespace podm::verify {

namespace {

// Returns the extent of each label.
std::map<std::uint32_t, VoxelBox> extents_of(const std::vector<std::uint32_t>& labels, const VoxelBox& box) {
  std::map<std::uint32_t, VoxelBox> extents;
  const std::uint32_t* label = labels.data();
  for (int k = box.first[2]; k < box.end(2); ++k)
    for (int j = box.first[1]; j < box.end(1); ++j)
      for (int i = box.first[0], run = i; i < box.end(0); label += run - i, i = run) {
        while (run < box.end(0) && label[run - i] == label[0]) ++run;
        const VoxelBox found{{i, j, k}, {run - i, 1, 1}};
        VoxelBox& extent = extents.try_emplace(*label, found).first->second;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const int end = std::max(extent.end(axis), found.end(axis));
          extent.first[axis] = std::min(extent.first[axis], found.first[axis]);
          extent.size[axis] = end - extent.first[axis];
        }
      }
  return extents;
}

// One axis of a volume: `inner` numbers per index, and `outer` such volumes.
struct Axis {
  int from_first, from_size, to_first, to_size;
  std::size_t inner, outer;
};

// Adds factor times the blurred numbers to `to`. Beyond `from` the numbers are 0.
void add_blurred_along(const Axis& axis, const std::vector<double>& taps, double factor,
                       const std::vector<double>& from, std::vector<double>& to) {
  const int reach = static_cast<int>(taps.size() / 2);
  for (std::size_t o = 0; o < axis.outer; ++o)
    for (int t = 0; t < axis.to_size; ++t) {
      double* sum =
          to.data() + (o * static_cast<std::size_t>(axis.to_size) + static_cast<std::size_t>(t)) * axis.inner;
      const int lowest = axis.to_first + t - reach - axis.from_first;  // the place in `from` of the first tap
      const int begin = std::max(0, lowest), end = std::min(axis.from_size, lowest + 2 * reach + 1);
      for (int f = begin; f < end; ++f) {
        const double* row =
            from.data() +
            (o * static_cast<std::size_t>(axis.from_size) + static_cast<std::size_t>(f)) * axis.inner;
        const double tap = factor * taps[static_cast<std::size_t>(f - lowest)];
        for (std::size_t i = 0; i < axis.inner; ++i) sum[i] += tap * row[i];
      }
    }
}

}  // namespace

LabelBlur::Taps LabelBlur::gaussian(const Image& image, double width_mm) {
  Taps taps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int reach = taps.reach[axis] = voxels_to_cover(3 * width_mm / image.spacing[axis]);
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
      const double mm = i * image.spacing[axis];
      taps.along[axis].push_back(std::exp(-mm * mm / (2 * width_mm * width_mm)));
      sum += taps.along[axis].back();
    }
    for (double& tap : taps.along[axis]) tap /= sum;
  }
  return taps;
}

LabelBlur::LabelBlur(const Image& image, double width_mm)
    : image_(image), narrow_(gaussian(image, width_mm)), wide_(gaussian(image, 2 * width_mm)) {}

const std::vector<double>& LabelBlur::leads(const VoxelBox& box) {
  box_ = box;
  around_ = box.grown(wide_.reach);
  copy_box(image_.voxels, image_.size, around_, labels_);
  own_.assign(box.count(), 0);
  others_.assign(box.count(), 0);
  for (const auto& [label, extent] : extents_of(labels_, around_)) {
    target_ = box.common(extent.grown(wide_.reach));
    if (target_.empty()) continue;
    weights_.assign(target_.count(), 0);
    add_blurred(label, extent, narrow_, 2);
    add_blurred(label, extent, wide_, -1);
    take_weights(label);
  }
  for (std::size_t i = 0; i < own_.size(); ++i) own_[i] -= others_[i];
  return own_;
}

// Only voxels of the label within reach of the taps from the target contribute.
void LabelBlur::add_blurred(std::uint32_t label, const VoxelBox& extent, const Taps& taps, double factor) {
  const VoxelBox source = extent.common(target_.grown(taps.reach));
  if (source.empty()) return;
  const auto in_row = static_cast<std::size_t>(target_.size[0]),
             in_plane = in_row * static_cast<std::size_t>(target_.size[1]),
             num_planes = static_cast<std::size_t>(source.size[2]);
  blur_rows(label, source, taps);
  planes_.assign(in_plane * num_planes, 0);
  add_blurred_along({source.first[1], source.size[1], target_.first[1], target_.size[1], in_row, num_planes},
                    taps.along[1], 1, rows_, planes_);
  add_blurred_along({source.first[2], source.size[2], target_.first[2], target_.size[2], in_plane, 1},
                    taps.along[2], factor, planes_, weights_);
}

// Fills rows_, which has the extent of the source along y and z and of the target along x.
void LabelBlur::blur_rows(std::uint32_t label, const VoxelBox& source, const Taps& taps) {
  const auto length = static_cast<std::size_t>(target_.size[0]);
  const std::vector<double>& along = taps.along[0];
  rows_.assign(length * static_cast<std::size_t>(source.size[1]) * static_cast<std::size_t>(source.size[2]),
               0);
  line_.resize(length + along.size() - 1);
  double* row = rows_.data();
  for (int k = source.first[2]; k < source.end(2); ++k)
    for (int j = source.first[1]; j < source.end(1); ++j, row += length) {
      const std::uint32_t* voxel = labels_.data() + around_.at(target_.first[0] - taps.reach[0], j, k);
      for (std::size_t i = 0; i < line_.size(); ++i) line_[i] = voxel[i] == label ? 1 : 0;
      for (std::size_t t = 0; t < along.size(); ++t)
        for (std::size_t i = 0; i < length; ++i) row[i] += along[t] * line_[i + t];
    }
}

void LabelBlur::take_weights(std::uint32_t label) {
  const double* weight = weights_.data();
  for (int k = target_.first[2]; k < target_.end(2); ++k)
    for (int j = target_.first[1]; j < target_.end(1); ++j)
      for (int i = target_.first[0]; i < target_.end(0); ++i, ++weight) {
        const std::size_t at = box_.at(i, j, k);
        if (labels_[around_.at(i, j, k)] == label)
          own_[at] = *weight;
        else
          others_[at] = std::max(others_[at], *weight);
      }
}

}  // namespace podm::verify
