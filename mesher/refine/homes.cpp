#include "refine/homes.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace podm {

Homes::Homes(std::vector<Work> work, unsigned num_homes) : number_(num_homes) {
  cuts_.reserve(num_homes);
  divide(work, num_homes);
}

void Homes::divide(std::span<Work> work, unsigned num_homes) {
  if (num_homes == 1) return;
  const unsigned half = num_homes / 2, axis = longest_side(work);
  std::sort(work.begin(), work.end(),
            [&](const Work& a, const Work& b) { return coordinate(a.at, axis) < coordinate(b.at, axis); });
  double total = 0;
  for (const Work& w : work) total += w.amount;
  const double wanted = total * half / num_homes;
  std::size_t count = 0;
  for (double low = 0; count < work.size() && low < wanted; ++count) low += work[count].amount;
  const bool is_cut = count > 0 && count < work.size();
  cuts_.push_back({axis, is_cut
                             ? (coordinate(work[count - 1].at, axis) + coordinate(work[count].at, axis)) / 2
                             : std::numeric_limits<double>::infinity()});
  divide(work.first(count), half);
  divide(work.subspan(count), num_homes - half);
}

unsigned Homes::longest_side(std::span<const Work> work) {
  if (work.empty()) return 0;
  unsigned longest = 0;
  double length = -1;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto before = [&](const Work& a, const Work& b) {
      return coordinate(a.at, axis) < coordinate(b.at, axis);
    };
    const auto [low, high] = std::minmax_element(work.begin(), work.end(), before);
    if (const double side = coordinate(high->at, axis) - coordinate(low->at, axis); side > length)
      std::tie(longest, length) = std::pair(axis, side);
  }
  return longest;
}

}  // namespace podm
