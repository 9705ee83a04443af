#include "isosurface/surface_masks.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "runtime/parallel_for.h"

namespace podm {

namespace {

// Marks a row of voxels, at first in one byte per voxel.
class RowMarker {
 public:
  explicit RowMarker(const LabelImage& image)
      : image_(image),
        row_(static_cast<std::size_t>(image.size[0])),
        slice_(row_ * static_cast<std::size_t>(image.size[1])),
        is_surface_((row_ + 3) / 4 * 4) {}

  /// Returns four bytes for each brick that the row passes.
  const std::vector<std::uint8_t>& operator()(int y, int z) {
    const LabelIndex* row = &image_.voxels[image_.index(0, y, z)];
    std::fill(is_surface_.begin(), is_surface_.end(), std::uint8_t{0});
    mark_differing(row, y > 0 ? row - row_ : nullptr, 0, row_);
    mark_differing(row, y + 1 < image_.size[1] ? row + row_ : nullptr, 0, row_);
    mark_differing(row, z > 0 ? row - slice_ : nullptr, 0, row_);
    mark_differing(row, z + 1 < image_.size[2] ? row + slice_ : nullptr, 0, row_);
    mark_differing(row, row + 1, 0, row_ - 1);
    mark_differing(row, row - 1, 1, row_);
    mark_differing(row, nullptr, 0, 1);
    mark_differing(row, nullptr, row_ - 1, row_);
    return is_surface_;
  }

 private:
  // Marks the voxels from `begin` to `end` that differ; `other` is null outside the grid. All variables of
  // the loops are local: bytes may alias members, and the loops would then not be vectorised.
  void mark_differing(const LabelIndex* row, const LabelIndex* other, std::size_t begin, std::size_t end) {
    if (other == nullptr && image_.is_box_flat) return;
    std::uint8_t* const is_surface = is_surface_.data();
    if (other == nullptr) {
      for (std::size_t x = begin; x < end; ++x) is_surface[x] |= row[x] != kBackground;
    } else {
      for (std::size_t x = begin; x < end; ++x) is_surface[x] |= row[x] != other[x];
    }
  }

  const LabelImage& image_;
  std::size_t row_, slice_;  // voxels
  std::vector<std::uint8_t> is_surface_;
};

// Packs four bytes, each 0 or 1, into four bits.
std::uint64_t packed(const std::uint8_t* bytes) {
  std::uint32_t four;
  std::memcpy(&four, bytes, sizeof four);
  return four * 0x10204080u >> 28;
}

}  // namespace

void mark_surface(const LabelImage& image, const BrickGrid& bricks, std::size_t threads,
                  SurfaceMasks& masks) {
  std::vector<RowMarker> markers(threads, RowMarker(image));
  const auto rows = static_cast<std::size_t>(bricks.size()[1]),
             layers = static_cast<std::size_t>(bricks.size()[2]);
  parallel_for(rows * layers, threads, [&](std::size_t r, std::size_t thread) {
    const int first_y = static_cast<int>(4 * (r % rows)), first_z = static_cast<int>(4 * (r / rows));
    std::uint64_t* const row_of_masks = &masks[r * static_cast<std::size_t>(bricks.size()[0])];
    for (int z = first_z; z < std::min(first_z + 4, image.size[2]); ++z) {
      for (int y = first_y; y < std::min(first_y + 4, image.size[1]); ++y) {
        const std::vector<std::uint8_t>& is_surface = markers[thread](y, z);
        const unsigned shift = place_in_brick({0, y, z});
        for (std::size_t x = 0; x < is_surface.size(); x += 4)
          row_of_masks[x / 4] |= packed(&is_surface[x]) << shift;
      }
    }
  });
}

}  // namespace podm
