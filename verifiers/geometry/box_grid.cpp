#include "geometry/box_grid.h"

#include <algorithm>
#include <cmath>

namespace podm::verify {

BoxGrid::BoxGrid(const std::vector<Bounds>& boxes) {
  if (boxes.empty()) {
    start_.assign(2, 0);
    return;
  }
  extent_ = boxes[0];
  Point mean{};
  for (const Bounds& box : boxes) {
    for (std::size_t a = 0; a < 3; ++a) {
      extent_.low[a] = std::min(extent_.low[a], box.low[a]);
      extent_.high[a] = std::max(extent_.high[a], box.high[a]);
      mean[a] += (box.high[a] - box.low[a]) / static_cast<double>(boxes.size());
    }
  }
  // Bins as large as the mean box, or as gives one bin a box where that is larger.
  double volume = 1;
  int dimension = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double length = extent_.high[a] - extent_.low[a];
    if (!(length > 0)) continue;
    volume *= length;
    ++dimension;
  }
  const double edge =
      dimension > 0 ? std::pow(volume / static_cast<double>(boxes.size()), 1.0 / dimension) : 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double length = extent_.high[a] - extent_.low[a];
    size_[a] = static_cast<std::size_t>(std::clamp(length / std::max(mean[a], edge), 1.0, 4096.0));
    bins_a_unit_[a] = length > 0 ? static_cast<double>(size_[a]) / length : 0;
  }
  const auto for_each_bin = [&](const Bounds& box, auto&& visit) {
    const auto low = bin_of(box.low), high = bin_of(box.high);
    for (std::size_t k = low[2]; k <= high[2]; ++k)
      for (std::size_t j = low[1]; j <= high[1]; ++j)
        for (std::size_t i = low[0]; i <= high[0]; ++i) visit((k * size_[1] + j) * size_[0] + i);
  };
  start_.assign(size_[0] * size_[1] * size_[2] + 2, 0);
  for (const Bounds& box : boxes) for_each_bin(box, [&](std::size_t bin) { ++start_[bin + 2]; });
  for (std::size_t b = 2; b < start_.size(); ++b) start_[b] += start_[b - 1];
  members_.resize(start_.back());
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for_each_bin(boxes[i], [&](std::size_t bin) { members_[start_[bin + 1]++] = i; });
  start_.pop_back();
}

std::array<std::size_t, 3> BoxGrid::bin_of(const Point& p) const {
  std::array<std::size_t, 3> bin{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = (p[a] - extent_.low[a]) * bins_a_unit_[a];
    bin[a] = at > 0 ? std::min(static_cast<std::size_t>(std::min(at, 1e9)), size_[a] - 1) : 0;
  }
  return bin;
}

}  // namespace podm::verify
