#include "image/foreground.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "image/image_by_bricks.h"
#include "image/rows_of_image.h"
#include "image/stretches.h"
#include "image/working_frame.h"
#include "podm/errors.h"

namespace podm {
namespace {

// Adds the voxels of a row.
void add_row(const LabelIndex* row, int size, LabelCounts& counts) {
  for_each_stretch(row, sizeof *row, 0, static_cast<std::size_t>(size),
                   [&](std::size_t from, std::size_t to, bool is_uniform) {
                     if (is_uniform) {
                       counts.of_label[row[from]] += to - from;
                     } else {
                       for (std::size_t i = from; i < to; ++i) ++counts.of_label[row[i]];
                     }
                   });
}

// The bounds of the foreground of some rows.
struct VoxelBounds {
  std::array<int, 3> low, high{-1, -1, -1};

  void operator+=(const VoxelBounds& b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], b.low[axis]);
      high[axis] = std::max(high[axis], b.high[axis]);
    }
  }

  void add_row(const LabelImage& image, int j, int k) {
    const auto row = image.voxels.begin() + static_cast<std::ptrdiff_t>(image.index(0, j, k));
    const auto end = row + image.size[0];
    const auto is_foreground = [](LabelIndex label) { return label != kBackground; };
    const auto first = std::find_if(row, end, is_foreground);
    if (first == end) return;
    const auto after_last =
        std::find_if(std::reverse_iterator(end), std::reverse_iterator(first), is_foreground).base();
    *this += {{static_cast<int>(first - row), j, k}, {static_cast<int>(after_last - row) - 1, j, k}};
  }
};

VoxelBounds voxel_bounds(const LabelImage& image, int threads) {
  if (const ImageByBricks* in_file = by_bricks(image)) return {in_file->low, in_file->high};
  return sum_over_rows(image, threads, VoxelBounds{image.size},
                       [&](VoxelBounds& bounds, int j, int k) { bounds.add_row(image, j, k); });
}

}  // namespace

std::vector<std::uint64_t> count_voxels(const LabelImage& image, int threads) {
  if (const ImageByBricks* in_file = by_bricks(image)) return in_file->voxels_of_label;
  const LabelCounts none{std::vector<std::uint64_t>(image.labels.size())};
  const auto add = [&](LabelCounts& counts, int j, int k) {
    add_row(&image.voxels[image.index(0, j, k)], image.size[0], counts);
  };
  return sum_over_rows(image, threads, none, add).of_label;
}

Box foreground_bounds(const LabelImage& image, int threads) {
  const VoxelBounds all = voxel_bounds(image, threads);
  if (all.high[0] < 0) throw InputError("the image has no foreground");
  const Affine a = voxels_to_working(image);
  const auto bound = [&](std::size_t row,
                         bool is_low) {  // the sum of the least, or greatest, term of each axis
    double sum = a[4 * row + 3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double entry = a[4 * row + axis];
      sum += entry * ((entry > 0) == is_low ? all.low[axis] - 1 : all.high[axis] + 1);
    }
    return sum;
  };
  return {{bound(0, true), bound(1, true), bound(2, true)},
          {bound(0, false), bound(1, false), bound(2, false)}};
}

}  // namespace podm
