#include "smoothing/interface_shift.h"

#include <algorithm>
#include <cmath>

namespace podm {

namespace {

// Sums `count` values, `stride` apart, from each of `num_sums` places on. Does so in each of `num_blocks`
// blocks of (num_sums + count - 1) * stride values.
void add_up_along(std::size_t stride, std::size_t num_blocks, std::size_t num_sums, std::size_t count,
                  std::vector<double>& values, std::vector<double>& sums) {
  sums.assign(num_blocks * num_sums * stride, 0);
  for (std::size_t block = 0; block < num_blocks; ++block) {
    const double* from = &values[block * (num_sums + count - 1) * stride];
    double* to = &sums[block * num_sums * stride];
    for (std::size_t n = 0; n < count; ++n)
      for (std::size_t at = 0; at < num_sums * stride; ++at) to[at] += from[n * stride + at];
  }
  values.swap(sums);
}

}  // namespace

InterfaceShift::InterfaceShift(const LabelImage& image, const VoxelWeights& weights,
                               const std::array<int, 3>& reach)
    : image_(image),
      weights_(weights),
      reach_(reach),
      stride_{1, image.index(0, 1, 0), image.index(0, 0, 1)} {
  const double shortest = *std::min_element(image.spacing.begin(), image.spacing.end());
  for (std::size_t a = 0; a < 3; ++a) {
    window_[a] = kTileSide + 2 * reach[a];
    area_of_face_[a] = std::max(1.0, std::round(256 * shortest / image.spacing[a]));
  }
}

std::size_t InterfaceShift::place_in_window(const Voxel& v) const {
  return (unsigned_of(v.k) * unsigned_of(window_[1]) + unsigned_of(v.j)) * unsigned_of(window_[0]) +
         unsigned_of(v.i);
}

InterfaceShift::Side InterfaceShift::side_of(const Voxel& v, std::size_t at) const {
  Side side{{}, image_.voxels[at], 0, 0};
  const std::array<int, 3> place{v.i, v.j, v.k};
  const auto meet = [&](std::size_t a, std::size_t beyond) {
    if (image_.voxels[beyond] == side.label) return;
    side.area += area_of_face_[a];
    side.lead += area_of_face_[a] * (int{weights_.at(at)} - int{weights_.at(beyond)});
  };
  for (std::size_t a = 0; a < 3; ++a) {
    if (place[a] > 0) meet(a, at - stride_[a]);
    if (place[a] + 1 < image_.size[a]) meet(a, at + stride_[a]);
  }
  return side;
}

void InterfaceShift::read_window(const Voxel& first, Scratch& scratch) const {
  scratch.sides.clear();
  scratch.labels.clear();
  const Voxel origin{first.i - reach_[0], first.j - reach_[1], first.k - reach_[2]};
  const auto is_in_tile = [&](int at, std::size_t a) {
    return at >= reach_[a] && at < reach_[a] + kTileSide;
  };
  const int begin = std::max(0, -origin.i), end = std::min(window_[0], image_.size[0] - origin.i);
  for (int k = std::max(0, -origin.k); k < std::min(window_[2], image_.size[2] - origin.k); ++k) {
    for (int j = std::max(0, -origin.j); j < std::min(window_[1], image_.size[1] - origin.j); ++j) {
      for (int i = begin; i < end; ++i) {
        const Voxel v{origin.i + i, origin.j + j, origin.k + k};
        const std::size_t at = image_.index(v.i, v.j, v.k);
        if (weights_.at(at) == VoxelWeights::kUnset) continue;
        const LabelIndex label = image_.voxels[at];
        if (is_in_tile(i, 0) && is_in_tile(j, 1) && is_in_tile(k, 2) &&
            std::find(scratch.labels.begin(), scratch.labels.end(), label) == scratch.labels.end())
          scratch.labels.push_back(label);
        Side side = side_of(v, at);
        side.at = {i, j, k};
        if (side.area > 0) scratch.sides.push_back(side);
      }
    }
  }
}

// Adds up the areas and leads in the box around each voxel of the tile, one axis after another.
void InterfaceShift::add_up(LabelIndex label, Scratch& scratch) const {
  const std::array<std::size_t, 3> window{unsigned_of(window_[0]), unsigned_of(window_[1]),
                                          unsigned_of(window_[2])};
  for (auto& sums : scratch.sums) sums.assign(window[0] * window[1] * window[2], 0);
  for (const Side& side : scratch.sides) {
    if (side.label != label) continue;
    scratch.sums[0][place_in_window(side.at)] = side.area;
    scratch.sums[1][place_in_window(side.at)] = side.lead;
  }
  constexpr std::size_t kSide = kTileSide;
  const auto count = [&](std::size_t a) { return unsigned_of(2 * reach_[a] + 1); };
  for (auto& sums : scratch.sums) {
    add_up_along(window[0] * window[1], 1, kSide, count(2), sums, scratch.along);
    add_up_along(window[0], kSide, kSide, count(1), sums, scratch.along);
    add_up_along(1, kSide * kSide, kSide, count(0), sums, scratch.along);
  }
}

const std::array<double, kTileVoxels>& InterfaceShift::shifts(const Voxel& first, Scratch& scratch) const {
  scratch.shifts.fill(0);
  read_window(first, scratch);
  for (const LabelIndex label : scratch.labels) {
    add_up(label, scratch);
    for (int k = 0; k < std::min(kTileSide, image_.size[2] - first.k); ++k)
      for (int j = 0; j < std::min(kTileSide, image_.size[1] - first.j); ++j)
        for (int i = 0; i < std::min(kTileSide, image_.size[0] - first.i); ++i) {
          const std::size_t at = image_.index(first.i + i, first.j + j, first.k + k);
          const std::size_t place = place_in_tile(i, j, k);
          if (image_.voxels[at] == label && scratch.sums[0][place] > 0)
            scratch.shifts[place] = scratch.sums[1][place] / (2 * scratch.sums[0][place]);
        }
  }
  return scratch.shifts;
}

}  // namespace podm
