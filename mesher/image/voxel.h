// Voxels, and the bricks of 4^3 voxels into which an image is cut. Both are numbered from the grid's corner.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "geometry/point.h"

namespace podm {

struct Voxel {
  int i = 0, j = 0, k = 0;
  friend bool operator==(const Voxel&, const Voxel&) = default;
};

inline Point center(const Voxel& v) {
  return {static_cast<double>(v.i), static_cast<double>(v.j), static_cast<double>(v.k)};
}

/// Converts a place or a count, which must not be negative.
constexpr std::size_t unsigned_of(int n) { return static_cast<std::size_t>(n); }

/// Relative difference up to which two lengths count as equal, as headers round spacings.
inline constexpr double kLengthRounding = 1e-5;

/// The least whole number of voxels that is at least as long, up to kLengthRounding.
inline int voxels_to_cover(double voxels) { return static_cast<int>(std::ceil(voxels - kLengthRounding)); }

/// A voxel's place in its brick, 0 to 63, x fastest. A Number is an integer, or a register of several
/// integers.
template <class Number>
constexpr Number place_in_brick(const Number& i, const Number& j, const Number& k) {
  return (i & 3) | (j & 3) << 2 | (k & 3) << 4;
}
constexpr unsigned place_in_brick(const Voxel& v) {
  return static_cast<unsigned>(place_in_brick(v.i, v.j, v.k));
}

/// The bricks of a grid. Bricks at its upper ends may extend beyond it.
class BrickGrid {
 public:
  BrickGrid() = default;
  /// `size` is in voxels along each axis.
  explicit BrickGrid(const std::array<int, 3>& size)
      : size_{num_bricks(size[0]), num_bricks(size[1]), num_bricks(size[2])} {}

  const std::array<int, 3>& size() const { return size_; }
  std::size_t count() const { return index(0, 0, size_[2]); }
  /// The index of the brick that is (i,j,k) from the corner.
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(i);
  }
  std::size_t index_of_voxel(const Voxel& v) const { return index(v.i >> 2, v.j >> 2, v.k >> 2); }
  bool contains(int i, int j, int k) const {
    return is_in(i, size_[0]) && is_in(j, size_[1]) && is_in(k, size_[2]);
  }

 private:
  static int num_bricks(int voxels) { return voxels / 4 + (voxels % 4 != 0); }
  static bool is_in(int i, int n) { return static_cast<unsigned>(i) < static_cast<unsigned>(n); }

  std::array<int, 3> size_{};
};

}  // namespace podm
