#include "claims/check_labels_reach.h"

#include <algorithm>
#include <cmath>

namespace podm::verify {

LabelReach::LabelReach(const Image& image, double reach_mm)
    : image_(image), mm_(reach_mm + std::hypot(image.spacing[0], image.spacing[1], image.spacing[2])) {}

bool LabelReach::has(std::uint32_t label, const Point& point) const {
  std::array<int, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = mm_ / image_.spacing[a], last = image_.size[a] - 1;
    low[a] = static_cast<int>(std::ceil(std::clamp(point[a] - reach, 0.0, last)));
    high[a] = static_cast<int>(std::floor(std::clamp(point[a] + reach, 0.0, last)));
  }
  const auto reaches_beyond = [&](std::size_t a) {
    return (point[a] + 1) * image_.spacing[a] <= mm_ ||
           (image_.size[a] - point[a]) * image_.spacing[a] <= mm_;
  };
  if (label == 0 && (reaches_beyond(0) || reaches_beyond(1) || reaches_beyond(2))) return true;
  const auto squared_mm = [&](std::size_t axis, int index) {
    const double mm = (index - point[axis]) * image_.spacing[axis];
    return mm * mm;
  };
  const auto row = static_cast<std::size_t>(image_.size[0]),
             slice = row * static_cast<std::size_t>(image_.size[1]);
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const double in_plane = squared_mm(2, k) + squared_mm(1, j);
      const std::size_t at = static_cast<std::size_t>(k) * slice + static_cast<std::size_t>(j) * row;
      for (int i = low[0]; i <= high[0]; ++i)
        if (image_.voxels[at + static_cast<std::size_t>(i)] == label &&
            in_plane + squared_mm(0, i) <= mm_ * mm_)
          return true;
    }
  }
  return false;
}

}  // namespace podm::verify
