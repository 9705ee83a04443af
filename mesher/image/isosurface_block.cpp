#include "image/isosurface_block.h"

namespace podm {

LabelIndex winner(const BlockLabels& labels, const Point& f) {
  const double x0 = 1 - f.x, y0 = 1 - f.y, z0 = 1 - f.z;
  const std::array<double, 4> yz = {y0 * z0, f.y * z0, y0 * f.z, f.y * f.z};
  CornerValues weight;
  for (std::size_t c = 0; c < 8; c += 2) {
    weight[c] = x0 * yz[c / 2];
    weight[c + 1] = f.x * yz[c / 2];
  }
  const auto weight_of = [&](LabelIndex label) {
    double sum = 0;
    for (std::size_t c = 0; c < 8; ++c) sum += labels.corner[c] == label ? weight[c] : 0;
    return sum;
  };
  LabelIndex best = labels.corner[0];
  double best_weight = weight_of(best);
  for (std::size_t c = 1; c < 8 && best_weight <= 0.5; ++c) {
    const LabelIndex label = labels.corner[c];
    if (label == best) continue;
    const double w = weight_of(label);
    if (w > best_weight || (w == best_weight && label < best)) {
      best = label;
      best_weight = w;
    }
  }
  return best;
}

}  // namespace podm
