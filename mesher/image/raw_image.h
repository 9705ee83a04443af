// An image as its file stores it, and how it becomes a LabelImage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// Voxels in the type of the file, x fastest.
using RawVoxels =
    std::variant<std::vector<std::uint8_t>, std::vector<std::int8_t>, std::vector<std::uint16_t>,
                 std::vector<std::int16_t>, std::vector<std::uint32_t>, std::vector<std::int32_t>,
                 std::vector<std::uint64_t>, std::vector<std::int64_t>, std::vector<float>,
                 std::vector<double>>;

struct RawImage {
  std::array<int, 3> size{};
  std::array<double, 12> voxel_to_ras{};  ///< row-major 3x4, mm
  RawVoxels voxels;
};

/// Checks sizes from a header: each at least 1 and an int, their product times `bytes_per_voxel` in range.
/// Returns that product, bytes. Throws InputError naming `path`.
std::uint64_t checked_image_bytes(const std::array<std::int64_t, 3>& size, std::size_t bytes_per_voxel,
                                  const std::string& path);

/// The image with its distinct values, in the order met, as `labels`: the background is not chosen yet.
/// A direction that is orthonormal but for the rounding of the header is made exactly so. Throws InputError
/// naming `path`: a singular affine, values that are no labels, too many of them.
LabelImage index_labels(RawImage&& raw, const std::string& path);

}  // namespace podm
