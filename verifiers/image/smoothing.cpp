#include "image/smoothing.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "image/label_blur.h"
#include "image/label_growth.h"
#include "image/raw_image.h"
#include "image/voxel_box.h"
#include "parallel.h"

namespace podm::verify {

namespace {

constexpr double kMostSpacings = 8;

void check_width(const Image& image, double width_mm) {
  const double shortest = *std::min_element(image.spacing.begin(), image.spacing.end());
  double side = image.size[0] * image.spacing[0];
  for (std::size_t axis = 1; axis < 3; ++axis) side = std::min(side, image.size[axis] * image.spacing[axis]);
  if (!(width_mm > 0) || width_mm > kMostSpacings * shortest || width_mm >= side)
    refuse(image.path,
           fmt::format(
               "cannot be smoothed by {} mm: the width is above 0, at most {:.6g} mm (8 times the shortest "
               "side of a voxel) and less than {:.6g} mm (the image's shortest side)",
               width_mm, kMostSpacings * shortest, side));
}

// Replaces the marks of the box grown by `reach` by marks of the box. A voxel is marked if a mark lies within
// reach along each axis.
void spread(const VoxelBox& box, const std::array<int, 3>& reach, std::vector<std::uint8_t>& marks) {
  std::array<int, 3> size = box.grown(reach).size;
  std::size_t inner = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto from = static_cast<std::size_t>(size[axis]), to = static_cast<std::size_t>(box.size[axis]);
    const std::size_t outer = marks.size() / (inner * from), window = from - to;
    std::vector<std::uint8_t> result(inner * to * outer);
    for (std::size_t o = 0; o < outer; ++o)
      for (std::size_t t = 0; t < to; ++t)
        for (std::size_t w = 0; w <= window; ++w)
          for (std::size_t i = 0; i < inner; ++i)
            result[(o * to + t) * inner + i] |= marks[(o * from + t + w) * inner + i];
    marks = std::move(result);
    inner *= to;
  }
}

class Smoother {
 public:
  Smoother(const Image& image, double width_mm, int threads)
      : image_(image),
        threads_(threads),
        grid_{{}, image.size},
        voxel_mm_(std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2])),
        unit_mm_(std::max(1.1 * width_mm, voxel_mm_ / 2) / kFullVoxelWeight),
        tiles_(tiles_of(image.size)),
        is_open_(image.voxels.size()),
        is_lost_(image.voxels.size()),
        voxel_weights_(image.voxels.size(), kFullVoxelWeight) {}

  std::vector<std::uint16_t> voxel_weights(double width_mm) {
    open_interfaces();
    for (double width = width_mm; !tiles_.empty() && !(width < (1 - kLengthRounding) * voxel_mm_ / 2);
         width /= 2) {
      weigh(width);
      keep_open_near_lost(width);
    }
    close_as_stairs();
    for (int time = 0; time < 2; ++time)
      voxel_weights_ =
          LabelGrowth(image_, voxel_weights_, width_mm, threads_).without_growth(voxel_weight_of(0));
    return std::move(voxel_weights_);
  }

 private:
  template <class Body>
  void for_tiles(Body body) {
    parallel_ranges(tiles_.size(), threads_,
                    [&](std::size_t begin, std::size_t end, std::size_t) { body(begin, end); });
  }

  template <class Visit>
  void for_open(const VoxelBox& tile, Visit visit) const {
    std::size_t in_tile = 0;
    for (int k = tile.first[2]; k < tile.end(2); ++k)
      for (int j = tile.first[1]; j < tile.end(1); ++j) {
        std::size_t at = grid_.at(tile.first[0], j, k);
        for (int i = tile.first[0]; i < tile.end(0); ++i, ++at, ++in_tile)
          if (is_open_[at] != 0) visit(at, in_tile);
      }
  }

  // Finds U of the header. Rows get a voxel of background at either end.
  void open_interfaces() {
    const auto length = static_cast<std::size_t>(image_.size[0]);
    const auto rows = static_cast<std::size_t>(image_.size[1]) * static_cast<std::size_t>(image_.size[2]);
    parallel_ranges(rows, threads_, [&](std::size_t begin, std::size_t end, std::size_t) {
      std::vector<std::uint32_t> middle(length + 2), other(length + 2), difference(length);
      for (std::size_t row = begin; row < end; ++row) {
        const int j = static_cast<int>(row % static_cast<std::size_t>(image_.size[1])),
                  k = static_cast<int>(row / static_cast<std::size_t>(image_.size[1]));
        copy_row(j, k, middle);
        std::fill(difference.begin(), difference.end(), 0);
        for (int neighbor = 0; neighbor < 9; ++neighbor) {
          copy_row(j + neighbor % 3 - 1, k + neighbor / 3 - 1, other);
          for (std::size_t i = 0; i < length; ++i)
            difference[i] |=
                (other[i] ^ middle[i + 1]) | (other[i + 1] ^ middle[i + 1]) | (other[i + 2] ^ middle[i + 1]);
        }
        for (std::size_t i = 0; i < length; ++i) is_open_[row * length + i] = difference[i] != 0 ? 1 : 0;
      }
    });
    shrink_tiles();
  }

  void copy_row(int j, int k, std::vector<std::uint32_t>& row) const {
    const bool is_inside = j >= 0 && k >= 0 && j < image_.size[1] && k < image_.size[2];
    if (!is_inside) return std::fill(row.begin(), row.end(), 0);
    const std::uint32_t* first = image_.voxels.data() + grid_.at(0, j, k);
    std::copy(first, first + image_.size[0], row.begin() + 1);
  }

  std::uint16_t voxel_weight_of(double depth_mm) const {
    return static_cast<std::uint16_t>(
        std::min(std::round(std::max(depth_mm, voxel_mm_ / 20) / unit_mm_), double{kFullVoxelWeight}));
  }

  void weigh(double width_mm) {
    const double depth_of_lead = width_mm * std::sqrt(2 * std::numbers::pi) / 3;
    for_tiles([&](std::size_t begin, std::size_t end) {
      LabelBlur blur(image_, width_mm);
      for (std::size_t t = begin; t < end; ++t) {
        const std::vector<double>& leads = blur.leads(tiles_[t]);
        for_open(tiles_[t], [&](std::size_t at, std::size_t in_tile) {
          const double depth = depth_of_lead * leads[in_tile];
          is_lost_[at] = depth < -voxel_mm_ / 4 ? 1 : 0;
          voxel_weights_[at] = voxel_weight_of(depth);
        });
      }
    });
  }

  void keep_open_near_lost(double width_mm) {
    std::array<int, 3> reach;
    for (std::size_t axis = 0; axis < 3; ++axis)
      reach[axis] = voxels_to_cover(2 * width_mm / image_.spacing[axis]);
    for_tiles([&](std::size_t begin, std::size_t end) {
      std::vector<std::uint8_t> is_near;
      for (std::size_t t = begin; t < end; ++t) {
        copy_box(is_lost_, image_.size, tiles_[t].grown(reach), is_near);
        spread(tiles_[t], reach, is_near);
        for_open(tiles_[t], [&](std::size_t at, std::size_t in_tile) { is_open_[at] = is_near[in_tile]; });
      }
    });
    shrink_tiles();
  }

  // Shrinks tiles to the boxes of their open voxels and drops tiles without any.
  void shrink_tiles() {
    for_tiles([&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) tiles_[t] = box_of_open(tiles_[t]);
    });
    std::erase_if(tiles_, [](const VoxelBox& tile) { return tile.empty(); });
  }

  VoxelBox box_of_open(const VoxelBox& tile) const {
    std::array<int, 3> low = tile.size, high{-1, -1, -1};
    for_open(tile, [&](std::size_t, std::size_t in_tile) {
      const auto width = static_cast<std::size_t>(tile.size[0]),
                 height = static_cast<std::size_t>(tile.size[1]);
      const std::array<int, 3> at{static_cast<int>(in_tile % width),
                                  static_cast<int>(in_tile / width % height),
                                  static_cast<int>(in_tile / (width * height))};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], at[axis]);
        high[axis] = std::max(high[axis], at[axis]);
      }
    });
    VoxelBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] = tile.first[axis] + low[axis];
      box.size[axis] = high[axis] + 1 - low[axis];
    }
    return box;
  }

  void close_as_stairs() {
    for_tiles([&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        for_open(tiles_[t],
                 [&](std::size_t at, std::size_t) { voxel_weights_[at] = voxel_weight_of(voxel_mm_ / 2); });
    });
    is_open_ = std::vector<std::uint8_t>();  // frees the memory
    is_lost_ = std::vector<std::uint8_t>();
  }

  const Image& image_;
  int threads_;
  VoxelBox grid_;
  double voxel_mm_, unit_mm_;  // h; the depth of a voxel weight of 1/65535
  std::vector<VoxelBox> tiles_;
  std::vector<std::uint8_t> is_open_, is_lost_;  // not decided yet; lost with this width
  std::vector<std::uint16_t> voxel_weights_;
};

}  // namespace

Smoothing smooth(const Image& image, double width_mm, int threads) {
  check_width(image, width_mm);
  return {width_mm, Smoother(image, width_mm, threads).voxel_weights(width_mm)};
}

}  // namespace podm::verify
