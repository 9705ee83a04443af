// The weights of all labels in a block, as trilinear forms.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "isosurface/isosurface_block.h"
#include "podm/label_image.h"

namespace podm {

/// A set of a block's labels by slot, one bit per slot.
using SlotMask = std::uint8_t;

inline std::size_t num_slots(SlotMask mask) { return static_cast<std::size_t>(std::popcount(mask)); }

/// The labels at the corners of a block, and the weights of the corners in whole units.
struct BlockCorners {
  std::array<LabelIndex, 8> labels;
  std::array<std::int32_t, 8> weights;
};

/// One trilinear form for each label of a block. Labels have slots in ascending order. The lower slot
/// therefore wins where two labels have equal weights.
class WeightForms {
 public:
  static constexpr std::size_t kMostSlots = 8;
  using Corners = std::array<std::int32_t, 8>;

  WeightForms() = default;
  explicit WeightForms(const BlockCorners& corners);

  std::size_t size() const { return size_; }
  LabelIndex label(std::size_t slot) const { return labels_[slot]; }
  /// The slot of a label that the block has.
  std::size_t slot(LabelIndex label) const {
    std::size_t s = 0;
    while (labels_[s] != label) ++s;
    return s;
  }
  /// The values of the form at the corners.
  const Corners& corners(std::size_t slot) const { return corners_[slot]; }
  Trilinear form(std::size_t slot) const;
  /// The value at a point, which is relative to the block's own voxel.
  double weight(std::size_t slot, const Point& f) const;

 private:
  std::size_t size_ = 0;
  std::array<LabelIndex, kMostSlots> labels_{};
  std::array<Corners, kMostSlots> corners_{};
};

/// The forms on a face of a block as a block of their own that is constant along its third axis. Its first
/// two axes are the face's, in the order a + 1, a + 2 (modulo 3) where `a` is the axis across the face. Both
/// blocks of a face get the same forms.
WeightForms forms_on_face(const BlockCorners& corners, std::size_t axis, bool is_upper);

}  // namespace podm
