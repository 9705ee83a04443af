// Labels by voxel and by block. A *block* is the box between eight voxel centers. Inside it every label has a
// trilinear weight, interpolated from the corners: a corner contributes 1, or the weight of its voxel. The
// greatest weight wins. Coordinates are in voxels: voxel (i,j,k) is centered at (i,j,k), and block (i,j,k)
// extends from there to (i+1,j+1,k+1).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "geometry/point.h"
#include "image/voxel.h"
#include "isosurface/oracle_reads.h"
#include "podm/label_image.h"

namespace podm {

/// The block that holds u.
inline Voxel block_of(const Point& u) {
  return {static_cast<int>(std::floor(u.x)), static_cast<int>(std::floor(u.y)),
          static_cast<int>(std::floor(u.z))};
}

/// Four copies of the label in a word.
inline std::uint64_t repeated(LabelIndex label) { return label * 0x0001'0001'0001'0001u; }
/// Bit l is set if the l-th labels of the two words differ.
inline unsigned differing(std::uint64_t four_labels, std::uint64_t others) {
  constexpr std::uint64_t kLow = 0x7fff'7fff'7fff'7fff;
  const std::uint64_t x = four_labels ^ others;
  const std::uint64_t top_bits = (((x & kLow) + kLow) | x) & ~kLow;
  return static_cast<unsigned>((top_bits >> 15) * 0x0001'0002'0004'0008 >> 48 & 0xf);
}

/// A set of a block's corners, one bit per corner. Corner i + 2 j + 4 k lies at (i,j,k) from the block's own
/// voxel.
using CornerMask = unsigned;
inline constexpr CornerMask kAllCorners = 0xff;
using CornerValues = std::array<double, 8>;

/// The bits of each number below 16, as doubles.
inline constexpr auto kBits = [] {
  std::array<std::array<double, 4>, 16> bits{};
  for (std::size_t m = 0; m < 16; ++m) {
    for (std::size_t b = 0; b < 4; ++b) bits[m][b] = static_cast<double>(m >> b & 1);
  }
  return bits;
}();
/// 1 at the corners of the set, 0 elsewhere.
constexpr CornerValues indicator(CornerMask mask) {
  const auto &low = kBits[mask & 15], &high = kBits[mask >> 4];
  return {low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]};
}

struct BlockLabels {
  std::array<LabelIndex, 8> corner;

  bool is_uniform(LabelIndex label) const {
    const auto words = std::bit_cast<std::array<std::uint64_t, 2>>(corner);
    return ((words[0] ^ repeated(label)) | (words[1] ^ repeated(label))) == 0;
  }
  CornerMask mask(LabelIndex label) const {
    const auto words = std::bit_cast<std::array<std::uint64_t, 2>>(corner);
    return ~(differing(words[0], repeated(label)) | differing(words[1], repeated(label)) << 4) & kAllCorners;
  }
  /// The label of the first corner in a set that is not empty.
  LabelIndex first(CornerMask mask) const { return corner[static_cast<std::size_t>(std::countr_zero(mask))]; }
};

/// A function that is linear along each axis, given by its values at the corners of a block.
class Trilinear {
 public:
  constexpr explicit Trilinear(const CornerValues& v)
      : value_(v[0]),
        x_(v[1] - v[0]),
        y_(v[2] - v[0]),
        z_(v[4] - v[0]),
        xy_(v[3] - v[2] - x_),
        xz_(v[5] - v[4] - x_),
        yz_(v[6] - v[4] - y_),
        xyz_(v[7] - v[6] - v[5] + v[4] - xy_) {}

  /// The value at f, which is in voxels from the block's own voxel.
  double value(const Point& f) const {
    return value_ + f.x * x_ + f.y * (y_ + f.x * xy_) + f.z * (z_ + f.x * xz_ + f.y * (yz_ + f.x * xyz_));
  }
  Vector gradient(const Point& f) const {
    return {x_ + f.y * xy_ + f.z * (xz_ + f.y * xyz_), y_ + f.x * xy_ + f.z * (yz_ + f.x * xyz_),
            z_ + f.x * xz_ + f.y * (yz_ + f.x * xyz_)};
  }
  /// The second derivative of value(f + s d) with respect to s, at s = 0.
  double second_derivative(const Point& f, const Vector& d) const {
    return 2 *
           (d.x * d.y * (xy_ + f.z * xyz_) + d.x * d.z * (xz_ + f.y * xyz_) + d.y * d.z * (yz_ + f.x * xyz_));
  }
  /// The coefficients of the powers of s in value(f + s d).
  std::array<double, 4> along(const Point& f, const Vector& d) const {
    return {value(f), dot(gradient(f), d), 0.5 * second_derivative(f, d), d.x * d.y * d.z * xyz_};
  }

 private:
  double value_, x_, y_, z_, xy_, xz_, yz_, xyz_;
};

/// Corners of a block that all have weight 1.
struct UnitWeights {
  constexpr CornerValues of(CornerMask mask) const { return indicator(mask); }
};
/// Corners that each have a weight of their own (voxel_weights.h).
struct CornerWeights {
  CornerValues values;

  /// The weights of the corners in the set, and 0 elsewhere.
  CornerValues of(CornerMask mask) const {
    CornerValues v = indicator(mask);
    for (std::size_t c = 0; c < 8; ++c) v[c] *= values[c];
    return v;
  }
};

/// The weight of the corners `a` minus that of the corners `b`.
template <class Weights = UnitWeights>
constexpr Trilinear weight_difference(CornerMask a, CornerMask b, const Weights& weights = {}) {
  CornerValues v = weights.of(a);
  const CornerValues w = weights.of(b);
  for (std::size_t c = 0; c < 8; ++c) v[c] -= w[c];
  return Trilinear(v);
}

/// The weight of the corners `mask` at f.
template <class Weights = UnitWeights>
double weight(CornerMask mask, const Point& f, const Weights& weights = {}) {
  const CornerValues v = weights.of(mask);
  std::array<double, 4> plane;
  for (std::size_t c = 0; c < 4; ++c) plane[c] = v[c] * (1 - f.z) + v[c + 4] * f.z;
  return (plane[0] * (1 - f.x) + plane[1] * f.x) * (1 - f.y) + (plane[2] * (1 - f.x) + plane[3] * f.x) * f.y;
}

struct Winner {
  LabelIndex label;
  double weight;
};
/// The label of greatest weight at `f`; a tie goes to the smaller label.
template <class Weights = UnitWeights>
Winner winner(const BlockLabels& labels, const Point& f, const Weights& weights = {});

extern template Winner winner(const BlockLabels&, const Point&, const UnitWeights&);
extern template Winner winner(const BlockLabels&, const Point&, const CornerWeights&);

class FeatureTransform;

/// Labels of an image. Outside are background or, with a flat box, the labels at the border. Keeps a
/// reference to the voxels. `Reads` receives each part of a row that is read. If the voxels stay in the
/// image's file, labels come from `transform`, the image's.
template <class Reads>
class LabelGrid {
 public:
  LabelGrid(const LabelImage& image, const Reads& reads, const FeatureTransform* transform = nullptr)
      : reads_(reads),
        transform_(image.voxels.empty() ? transform : nullptr),
        voxels_(image.voxels.data()),
        num_x_(image.size[0]),
        num_y_(image.size[1]),
        num_z_(image.size[2]),
        goes_on_(image.is_box_flat),
        row_(static_cast<std::size_t>(num_x_)),
        slice_(row_ * static_cast<std::size_t>(num_y_)) {}

  int num_x() const { return num_x_; }
  int num_y() const { return num_y_; }
  int num_z() const { return num_z_; }

  bool contains(const Voxel& v) const {
    return is_in(v.i, num_x_) && is_in(v.j, num_y_) && is_in(v.k, num_z_);
  }

  /// `v` must be inside the grid.
  LabelIndex label_inside(const Voxel& v) const {
    if (transform_ != nullptr) [[unlikely]]
      return label_from_transform(v);
    return *row_from(index(v));
  }
  LabelIndex label(const Voxel& v) const {
    if (contains(v)) return label_inside(v);
    return goes_on_ ? label_inside(at_border(v)) : kBackground;
  }
  void prefetch(const Voxel& v) const {
    if (transform_ == nullptr) __builtin_prefetch(voxels_ + index(v));
  }

  BlockLabels block(const Voxel& b) const {
    BlockLabels labels;
    if (transform_ != nullptr) [[unlikely]]
      return block_from_transform(b);
    if (is_in(b.i, num_x_ - 1) && is_in(b.j, num_y_ - 1) && is_in(b.k, num_z_ - 1)) {
      const std::size_t first = index(b);
      std::memcpy(&labels.corner[0], row_from(first), 2 * sizeof(LabelIndex));
      std::memcpy(&labels.corner[2], row_from(first + row_), 2 * sizeof(LabelIndex));
      std::memcpy(&labels.corner[4], row_from(first + slice_), 2 * sizeof(LabelIndex));
      std::memcpy(&labels.corner[6], row_from(first + slice_ + row_), 2 * sizeof(LabelIndex));
    } else if (goes_on_) [[unlikely]] {
      return block_beyond_border(b);
    } else {
      for (int c = 0; c < 8; ++c) {
        const Voxel v{b.i + (c & 1), b.j + (c >> 1 & 1), b.k + (c >> 2)};
        labels.corner[static_cast<std::size_t>(c)] = contains(v) ? label_inside(v) : kBackground;
      }
    }
    return labels;
  }

  /// The voxel inside that is nearest to v.
  Voxel at_border(const Voxel& v) const {
    return {std::clamp(v.i, 0, num_x_ - 1), std::clamp(v.j, 0, num_y_ - 1), std::clamp(v.k, 0, num_z_ - 1)};
  }

 private:
  std::size_t index(const Voxel& v) const {
    return static_cast<std::size_t>(v.k) * slice_ + static_cast<std::size_t>(v.j) * row_ +
           static_cast<std::size_t>(v.i);
  }
  static bool is_in(int i, int n) { return static_cast<unsigned>(i) < static_cast<unsigned>(n); }
  const LabelIndex* row_from(std::size_t index) const {
    reads_.image(index);
    return voxels_ + index;
  }

  LabelIndex label_from_transform(const Voxel& v) const;
  BlockLabels block_beyond_border(const Voxel& b) const;
  BlockLabels block_from_transform(const Voxel& b) const;

  [[no_unique_address]] Reads reads_;
  const FeatureTransform* transform_;  // null if the image holds its voxels
  const LabelIndex* voxels_;
  int num_x_, num_y_, num_z_;
  bool goes_on_;             // the image, beyond its border
  std::size_t row_, slice_;  // voxels
};

extern template class LabelGrid<NoReads>;
extern template class LabelGrid<CountedReads>;

}  // namespace podm
