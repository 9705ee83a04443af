#include "image/label_depths.h"

#include <algorithm>

namespace podm {

void find_label_depths(VoxelField& depths, double most_mm) {
  depths.sweep([&](const std::vector<LabelIndex>& labels, const std::vector<float>& before, std::size_t i,
                   double spacing_mm) {
    float least = before[i];
    // An index before the first wraps around.
    const auto look = [&](std::size_t at, float cost) {
      const bool is_beyond = at >= labels.size();
      const bool is_own = (is_beyond ? kBackground : labels[at]) == labels[i];
      if (is_own && is_beyond) return;
      least = std::min(least, (is_own ? before[at] : 0) + cost);
    };
    for (std::size_t n = 1; (static_cast<double>(n) - 0.5) * spacing_mm < most_mm; ++n) {
      const double box_mm = (static_cast<double>(n) - 0.5) * spacing_mm;
      const auto cost = static_cast<float>(box_mm * box_mm);
      if (cost >= least) break;
      look(i - n, cost);
      look(i + n, cost);
    }
    return least;
  });
}

void unite_balls(VoxelField& balls, double most_mm) {
  balls.sweep([&](const std::vector<LabelIndex>&, const std::vector<float>& before, std::size_t i,
                  double spacing_mm) {
    float least = before[i];
    for (std::size_t n = 1; static_cast<double>(n) * spacing_mm < most_mm; ++n) {
      const double far_mm = static_cast<double>(n) * spacing_mm;
      const auto cost = static_cast<float>(far_mm * far_mm);
      if (i >= n) least = std::min(least, before[i - n] + cost);
      if (i + n < before.size()) least = std::min(least, before[i + n] + cost);
    }
    return least;
  });
}

}  // namespace podm
