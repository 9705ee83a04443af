#include "image/interface_sides.h"

#include <algorithm>

namespace podm {

namespace {

std::uint64_t count_foreground(const LabelIndex* row, int size) {
  std::uint32_t count = 0;
  for (int i = 0; i < size; ++i) count += row[i] != kBackground;
  return count;
}

// Counts the sides of interfaces that have a label. The counts of a part of the row fit in the words of the
// labels, so that one instruction of the processor counts as many pairs as it compares.
std::uint64_t count_sides(const LabelIndex* a, const LabelIndex* b, int size) {
  constexpr int kPart = 1 << 14;
  std::uint64_t sum = 0;
  for (int begin = 0; begin < size; begin += kPart) {
    LabelIndex count = 0;
    for (int i = begin; i < std::min(size, begin + kPart); ++i)
      count =
          static_cast<LabelIndex>(count + (a[i] == b[i] ? 0 : (a[i] != kBackground) + (b[i] != kBackground)));
    sum += count;
  }
  return sum;
}

}  // namespace

std::uint64_t count_sides(const LabelImage& image, std::size_t axis, int lag, int j, int k) {
  const int size = image.size[0];
  const LabelIndex* const row = &image.voxels[image.index(0, j, k)];
  if (axis == 0) {
    const int inside = std::max(0, size - lag), border = size - inside;
    return count_sides(row, row + lag, inside) + count_foreground(row, border) +
           count_foreground(row + inside, border);
  }
  const int position = axis == 1 ? j : k;
  const std::size_t step = image.index(0, axis == 1 ? 1 : 0, axis == 1 ? 0 : 1);
  const std::uint64_t foreground =
      position < lag || position + lag >= image.size[axis] ? count_foreground(row, size) : 0;
  const std::uint64_t after = position + lag < image.size[axis]
                                  ? count_sides(row, row + step * static_cast<std::size_t>(lag), size)
                                  : foreground;
  return after + (position < lag ? foreground : 0);
}

}  // namespace podm
