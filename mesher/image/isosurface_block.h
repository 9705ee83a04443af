// Labels by voxel and by block. A *block* is the box between eight voxel centres; inside it every label has a
// trilinear weight, and the greatest weight wins. Coordinates here are in voxels: voxel (i,j,k) is centred at
// (i,j,k), and block (i,j,k) reaches from there to (i+1,j+1,k+1).
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "geometry/point.h"
#include "podm/label_image.h"

namespace podm {

struct Voxel {
  int i = 0, j = 0, k = 0;
  friend bool operator==(const Voxel&, const Voxel&) = default;
};

inline Point center(const Voxel& v) {
  return {static_cast<double>(v.i), static_cast<double>(v.j), static_cast<double>(v.k)};
}
/// The block that holds u.
inline Voxel block_of(const Point& u) {
  return {static_cast<int>(std::floor(u.x)), static_cast<int>(std::floor(u.y)),
          static_cast<int>(std::floor(u.z))};
}

/// The labels of a block's corners; corner i + 2 j + 4 k lies at (i,j,k) from the block's own voxel.
struct BlockLabels {
  std::array<LabelIndex, 8> corner;

  bool is_uniform(LabelIndex label) const {
    const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(corner);
    const std::uint64_t expected = label * 0x0001000100010001u;
    return ((halves[0] ^ expected) | (halves[1] ^ expected)) == 0;
  }
};

/// Values at a block's corners, ordered as in BlockLabels, interpolated in between.
using CornerValues = std::array<double, 8>;

inline double interpolate(double a, double b, double t) { return a + t * (b - a); }

/// At `f`, coordinates in the block, each in [0,1].
inline double interpolate(const CornerValues& v, const Point& f) {
  const double y0 = interpolate(interpolate(v[0], v[1], f.x), interpolate(v[2], v[3], f.x), f.y);
  const double y1 = interpolate(interpolate(v[4], v[5], f.x), interpolate(v[6], v[7], f.x), f.y);
  return interpolate(y0, y1, f.z);
}

/// Per voxel along each axis.
inline Vector gradient(const CornerValues& v, const Point& f) {
  const auto bilinear = [](double a, double b, double c, double d, double s, double t) {
    return interpolate(interpolate(a, b, s), interpolate(c, d, s), t);
  };
  return {bilinear(v[1] - v[0], v[3] - v[2], v[5] - v[4], v[7] - v[6], f.y, f.z),
          bilinear(v[2] - v[0], v[3] - v[1], v[6] - v[4], v[7] - v[5], f.x, f.z),
          bilinear(v[4] - v[0], v[5] - v[1], v[6] - v[2], v[7] - v[3], f.x, f.y)};
}

/// +1 where label a is, -1 where b is, 0 elsewhere: interpolates to the weight of a less that of b.
inline CornerValues weight_difference(const BlockLabels& labels, LabelIndex a, LabelIndex b) {
  CornerValues v;
  for (std::size_t c = 0; c < 8; ++c) v[c] = double(labels.corner[c] == a) - double(labels.corner[c] == b);
  return v;
}

/// The label of greatest weight at `f`, ties to the smaller label.
LabelIndex winner(const BlockLabels& labels, const Point& f);

/// Labels of an image, background outside. Keeps a reference to the image.
class LabelGrid {
 public:
  explicit LabelGrid(const LabelImage& image)
      : voxels_(image.voxels.data()),
        num_x_(image.size[0]),
        num_y_(image.size[1]),
        num_z_(image.size[2]),
        row_(static_cast<std::size_t>(num_x_)),
        slice_(row_ * static_cast<std::size_t>(num_y_)),
        inverse_row_(1 / static_cast<double>(row_)),
        inverse_slice_(1 / static_cast<double>(slice_)) {}

  int num_x() const { return num_x_; }
  int num_y() const { return num_y_; }
  int num_z() const { return num_z_; }

  bool contains(const Voxel& v) const {
    return is_in(v.i, num_x_) && is_in(v.j, num_y_) && is_in(v.k, num_z_);
  }

  std::size_t index(const Voxel& v) const {
    return static_cast<std::size_t>(v.k) * slice_ + static_cast<std::size_t>(v.j) * row_ +
           static_cast<std::size_t>(v.i);
  }
  // Exact: (index + 0.5) / n is at least 0.5 / n from an integer, far more than it is rounded by.
  Voxel voxel(std::uint32_t index) const {
    const auto k = static_cast<std::uint32_t>((index + 0.5) * inverse_slice_);
    const auto in_slice = static_cast<std::uint32_t>(index - k * slice_);
    const auto j = static_cast<std::uint32_t>((in_slice + 0.5) * inverse_row_);
    return {static_cast<int>(in_slice - j * row_), static_cast<int>(j), static_cast<int>(k)};
  }

  LabelIndex label(std::size_t index) const { return voxels_[index]; }
  LabelIndex label(const Voxel& v) const { return contains(v) ? voxels_[index(v)] : kBackground; }

  BlockLabels block(const Voxel& b) const {
    BlockLabels labels;
    if (is_in(b.i, num_x_ - 1) && is_in(b.j, num_y_ - 1) && is_in(b.k, num_z_ - 1)) {
      const LabelIndex* const first = voxels_ + index(b);
      const std::array<const LabelIndex*, 4> pairs = {first, first + row_, first + slice_,
                                                      first + slice_ + row_};
      for (std::size_t p = 0; p < 4; ++p) {
        std::memcpy(&labels.corner[2 * p], pairs[p], 2 * sizeof(LabelIndex));
      }
    } else {
      for (int c = 0; c < 8; ++c) {
        labels.corner[static_cast<std::size_t>(c)] =
            label({b.i + (c & 1), b.j + (c >> 1 & 1), b.k + (c >> 2)});
      }
    }
    return labels;
  }

 private:
  static bool is_in(int i, int n) { return static_cast<unsigned>(i) < static_cast<unsigned>(n); }

  const LabelIndex* voxels_;
  int num_x_, num_y_, num_z_;
  std::size_t row_, slice_;  // voxels
  double inverse_row_, inverse_slice_;
};

}  // namespace podm
