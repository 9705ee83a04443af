#include "isosurface/isosurface_block.h"

#include "isosurface/feature_transform.h"

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

template <class Reads>
LabelIndex LabelGrid<Reads>::label_from_transform(const Voxel& v) const {
  return Features<Reads>(*transform_, reads_).label(v);
}

template <class Reads>
BlockLabels LabelGrid<Reads>::block_from_transform(const Voxel& b) const {
  const Features<Reads> features(*transform_, reads_);
  BlockLabels labels;
  for (int c = 0; c < 8; ++c) {
    const Voxel v{b.i + (c & 1), b.j + (c >> 1 & 1), b.k + (c >> 2)};
    labels.corner[static_cast<std::size_t>(c)] = contains(v) ? features.label(v)
                                                 : goes_on_  ? features.label(at_border(v))
                                                             : kBackground;
  }
  return labels;
}

template <class Reads>
BlockLabels LabelGrid<Reads>::block_beyond_border(const Voxel& b) const {
  BlockLabels labels;
  for (int c = 0; c < 8; ++c)
    labels.corner[static_cast<std::size_t>(c)] =
        label_inside(at_border({b.i + (c & 1), b.j + (c >> 1 & 1), b.k + (c >> 2)}));
  return labels;
}

template class LabelGrid<NoReads>;
template class LabelGrid<CountedReads>;

}  // namespace podm
