#include "claims/minima_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace podm::verify {

MinimaPyramid::MinimaPyramid(const std::array<int, 3>& size, const std::array<double, 3>& spacing,
                             double slope, std::vector<float> values)
    : spacing_(spacing), slope_(slope) {
  levels_.push_back({size, std::move(values)});
  while (levels_.back().minima.size() > 1) levels_.push_back(halved(levels_.back()));
}

float MinimaPyramid::minimum(const Level& level, const Block& block) {
  const auto at = [&](std::size_t axis) { return static_cast<std::size_t>(block[axis]); };
  const auto nx = static_cast<std::size_t>(level.size[0]), ny = static_cast<std::size_t>(level.size[1]);
  return level.minima[(at(2) * ny + at(1)) * nx + at(0)];
}

MinimaPyramid::Level MinimaPyramid::halved(const Level& level) {
  Level half;
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    half.size[axis] = (level.size[axis] + 1) / 2;
    count *= static_cast<std::size_t>(half.size[axis]);
  }
  half.minima.assign(count, std::numeric_limits<float>::infinity());
  std::size_t from = 0;
  for (int k = 0; k < level.size[2]; ++k)
    for (int j = 0; j < level.size[1]; ++j) {
      const auto row = static_cast<std::size_t>(k / 2) * static_cast<std::size_t>(half.size[1]) +
                       static_cast<std::size_t>(j / 2);
      float* const to = half.minima.data() + row * static_cast<std::size_t>(half.size[0]);
      for (int i = 0; i < level.size[0]; ++i, ++from) to[i / 2] = std::min(to[i / 2], level.minima[from]);
    }
  return half;
}

// Returns the block's minimum, grown over the distance from the block to the place.
double MinimaPyramid::grown(std::size_t level, const Block& block, const Point& place) const {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t first = std::int64_t{block[axis]} << level;
    const std::int64_t last =
        std::min(first + (std::int64_t{1} << level), std::int64_t{levels_[0].size[axis]}) - 1;
    const double along = spacing_[axis] * std::max({static_cast<double>(first) - place[axis],
                                                    place[axis] - static_cast<double>(last), 0.0});
    squared += along * along;
  }
  return static_cast<double>(minimum(levels_[level], block)) + slope_ * std::sqrt(squared);
}

// The half of the block that is nearer to the place comes first.
void MinimaPyramid::lower(std::size_t level, const Block& block, const Point& place, double enough,
                          double& least) const {
  if (least < enough) return;
  const double own = grown(level, block, place);
  if (!(own < least)) return;
  if (level == 0) {
    least = own;
    return;
  }
  const Level& halves = levels_[level - 1];
  Block first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto middle = static_cast<double>((2 * std::int64_t{block[axis]} + 1) << (level - 1)) - 0.5;
    first[axis] = place[axis] > middle ? 1 : 0;
  }
  for (unsigned turn = 0; turn < 8; ++turn) {
    Block half;
    bool is_in_grid = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half[axis] = 2 * block[axis] + (first[axis] ^ static_cast<int>(turn >> axis & 1));
      is_in_grid = is_in_grid && half[axis] < halves.size[axis];
    }
    if (is_in_grid) lower(level - 1, half, place, enough, least);
  }
}

double MinimaPyramid::least_at(const Point& place, double limit, double enough) const {
  lower(levels_.size() - 1, {0, 0, 0}, place, enough, limit);
  return limit;
}

}  // namespace podm::verify
