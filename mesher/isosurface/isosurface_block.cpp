#include "isosurface/isosurface_block.h"

namespace podm {

template <class Weights>
Winner winner(const BlockLabels& labels, const Point& f, const Weights& weights) {
  const LabelIndex label = labels.corner[0];
  const CornerMask mask = labels.mask(label);
  Winner best{label, weight(mask, f, weights)};
  CornerMask rest = ~mask & kAllCorners;
  while (rest != 0) {
    const LabelIndex other = labels.first(rest);
    const CornerMask others = labels.mask(other);
    const double w = weight(others, f, weights);
    if (w > best.weight || (w == best.weight && other < best.label)) best = {other, w};
    rest &= ~others;
  }
  return best;
}

template Winner winner(const BlockLabels&, const Point&, const UnitWeights&);
template Winner winner(const BlockLabels&, const Point&, const CornerWeights&);
template class LabelGrid<NoReads>;
template class LabelGrid<CountedReads>;

}  // namespace podm
