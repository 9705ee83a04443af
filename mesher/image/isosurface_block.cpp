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

template class LabelGrid<NoReads>;
template class LabelGrid<CountedReads>;

}  // namespace podm
