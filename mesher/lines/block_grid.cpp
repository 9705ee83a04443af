#include "lines/block_grid.h"

#include <algorithm>

namespace podm {

BlockCorners BlockGrid::corners(const Voxel& block) const {
  BlockCorners corners;
  for (int c = 0; c < 8; ++c) {
    const Voxel v{block.i + (c & 1), block.j + (c >> 1 & 1), block.k + (c >> 2)};
    const auto at = static_cast<std::size_t>(c);
    corners.labels[at] = is_box_flat_ || contains(v) ? nearest_label(v) : kBackground;
    corners.weights[at] = weight(v);
  }
  return corners;
}

LatticeRange BlockGrid::range(const Voxel& block) const {
  LatticeRange range;
  if (!is_box_flat_) return range;
  const std::array<int, 3> place{block.i, block.j, block.k};
  for (std::size_t a = 0; a < 3; ++a) {
    if (place[a] < 0) range.low[a] = kLatticeSteps / 2;
    if (place[a] == size(a) - 1) range.high[a] = kLatticeSteps / 2;
  }
  return range;
}

// Reads a row of voxels with one more at each end.
void BlockGrid::read_row(int j, int k, LabelIndex* row) const {
  const int num_x = image_.size[0];
  if (!is_box_flat_ && !contains({0, j, k})) {
    std::fill_n(row, num_x + 2, kBackground);
    return;
  }
  const LabelIndex* const voxels = &image_.voxels[index_of_nearest({0, j, k})];
  std::copy_n(voxels, num_x, row + 1);
  row[0] = is_box_flat_ ? voxels[0] : kBackground;
  row[num_x + 1] = is_box_flat_ ? voxels[num_x - 1] : kBackground;
}

// A block has a third label exactly if some corner has neither the least nor the greatest label.
void BlockGrid::find_blocks(int j, int k, RowScratch& scratch, std::vector<int>& blocks) const {
  const auto size = static_cast<std::size_t>(image_.size[0]) + 2;
  for (std::size_t r = 0; r < 4; ++r) {
    scratch.rows[r].resize(size);
    read_row(j + static_cast<int>(r & 1), k + static_cast<int>(r >> 1), scratch.rows[r].data());
  }
  scratch.least.resize(size);
  scratch.greatest.resize(size);
  scratch.has_third.resize(size);
  const LabelIndex *const a = scratch.rows[0].data(), *const b = scratch.rows[1].data(),
                          *const c = scratch.rows[2].data(), *const d = scratch.rows[3].data();
  LabelIndex *const least = scratch.least.data(), *const greatest = scratch.greatest.data();
  std::uint8_t* const has_third = scratch.has_third.data();
  for (std::size_t x = 0; x < size; ++x) {
    least[x] = std::min(std::min(a[x], b[x]), std::min(c[x], d[x]));
    greatest[x] = std::max(std::max(a[x], b[x]), std::max(c[x], d[x]));
  }
  for (std::size_t x = 0; x + 1 < size; ++x) {
    const LabelIndex low = std::min(least[x], least[x + 1]), high = std::max(greatest[x], greatest[x + 1]);
    const auto differs = [&](LabelIndex label) { return (label != low) & (label != high); };
    has_third[x] = differs(a[x]) | differs(b[x]) | differs(c[x]) | differs(d[x]) | differs(a[x + 1]) |
                   differs(b[x + 1]) | differs(c[x + 1]) | differs(d[x + 1]);
  }
  for (std::size_t x = 0; x + 1 < size; ++x)
    if (has_third[x] != 0) blocks.push_back(static_cast<int>(x) - 1);
}

}  // namespace podm
