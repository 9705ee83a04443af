// A box of voxels, and a copy of a grid's values in and around it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace podm::verify {

/// Lengths that are meant to be equal may differ by this much, as headers round spacings.
inline constexpr double kLengthRounding = 1e-5;

/// Returns the least whole number of voxels that is not less, up to this rounding.
inline int voxels_to_cover(double voxels) { return static_cast<int>(std::ceil(voxels - kLengthRounding)); }

struct VoxelBox {
  std::array<int, 3> first{}, size{};

  int end(std::size_t axis) const { return first[axis] + size[axis]; }
  bool empty() const { return size[0] <= 0 || size[1] <= 0 || size[2] <= 0; }
  std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
  VoxelBox grown(const std::array<int, 3>& reach) const {
    VoxelBox box = *this;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] -= reach[axis];
      box.size[axis] += 2 * reach[axis];
    }
    return box;
  }
  VoxelBox common(const VoxelBox& other) const {
    VoxelBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] = std::max(first[axis], other.first[axis]);
      box.size[axis] = std::min(end(axis), other.end(axis)) - box.first[axis];
    }
    return box;
  }
  /// Returns the position of voxel (i,j,k) in the box, x fastest.
  std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(k - first[2]) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(j - first[1])) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i - first[0]);
  }
};

/// Returns the grid in boxes of 32 voxels per side. The data computed for one box then fit a processor's
/// cache.
inline std::vector<VoxelBox> tiles_of(const std::array<int, 3>& size) {
  constexpr int kSide = 32;
  std::vector<VoxelBox> tiles;
  std::array<int, 3> at{};
  for (at[2] = 0; at[2] < size[2]; at[2] += kSide)
    for (at[1] = 0; at[1] < size[1]; at[1] += kSide)
      for (at[0] = 0; at[0] < size[0]; at[0] += kSide)
        tiles.push_back(VoxelBox{at, {kSide, kSide, kSide}}.common({{}, size}));
  return tiles;
}

/// Copies the values of a grid of size `size`, x fastest, in the box. Beyond the grid they continue as at its
/// border.
template <class Value>
void copy_box(const std::vector<Value>& grid, const std::array<int, 3>& size, const VoxelBox& box,
              std::vector<Value>& copy) {
  const VoxelBox all{{}, size};
  const auto inside = [&](int index, std::size_t axis) { return std::clamp(index, 0, size[axis] - 1); };
  copy.resize(box.count());
  auto to = copy.begin();
  for (int k = box.first[2]; k < box.end(2); ++k)
    for (int j = box.first[1]; j < box.end(1); ++j) {
      const Value* row = grid.data() + all.at(0, inside(j, 1), inside(k, 2));
      for (int i = box.first[0]; i < box.end(0); ++i) *to++ = row[inside(i, 0)];
    }
}

}  // namespace podm::verify
