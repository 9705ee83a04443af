#include "image/isosurface_block.h"

namespace podm {

Winner winner(const BlockLabels& labels, const Point& f) {
  const LabelIndex label = labels.corner[0];
  const CornerMask mask = labels.mask(label);
  Winner best{label, weight(mask, f)};
  CornerMask rest = ~mask & kAllCorners;
  while (rest != 0) {
    const LabelIndex other = labels.first(rest);
    const CornerMask others = labels.mask(other);
    const double w = weight(others, f);
    if (w > best.weight || (w == best.weight && other < best.label)) best = {other, w};
    rest &= ~others;
  }
  return best;
}

template <class Reads>
std::uint64_t LabelGrid<Reads>::corners_of_other_label(const Voxel& b, LabelIndex label) const {
  std::uint64_t bits = 0;
  const bool is_interior =
      b.i >= 1 && b.j >= 1 && b.k >= 1 && b.i + 2 < num_x_ && b.j + 2 < num_y_ && b.k + 2 < num_z_;
  if (is_interior) {
    const std::size_t first = index({b.i - 1, b.j - 1, b.k - 1});
    for (std::size_t line = 0; line < 16; ++line) {
      std::uint64_t four_labels;
      std::memcpy(&four_labels, row_from(first + (line & 3) * row_ + (line >> 2) * slice_),
                  sizeof four_labels);
      bits |= std::uint64_t{differing(four_labels, repeated(label))} << (4 * line);
    }
  } else {
    for (int c = 0; c < 64; ++c) {
      const Voxel v{b.i - 1 + (c & 3), b.j - 1 + (c >> 2 & 3), b.k - 1 + (c >> 4)};
      bits |= static_cast<std::uint64_t>(this->label(v) != label) << c;
    }
  }
  return bits;
}

template class LabelGrid<NoReads>;
template class LabelGrid<CountedReads>;

}  // namespace podm
