// An image as its file stores it, and the checks every reader shares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "podm/image_io.h"

namespace podm {

std::size_t bytes_of(VoxelType type);

struct RawImage {
  std::string path;       ///< for messages
  std::vector<int> size;  ///< voxels per axis, as many axes as the file has
  VoxelType type = VoxelType::kUint8;
  double slope = 1, intercept = 0;         ///< a value is slope * voxel + intercept
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, mm
  std::vector<unsigned char> bytes;        ///< voxels, x fastest, this machine's byte order
  std::vector<std::string> warnings = {};  ///< become those of LabelImage
};

/// Where its voxels lie.
VoxelArray array_of(const RawImage& raw);

/// Turns values of `width` bytes into the other byte order.
void swap_bytes(std::vector<unsigned char>& bytes, std::size_t width);

/// Throws InputError "path: fault".
[[noreturn]] void refuse(const std::string& path, const std::string& fault);

/// The number of voxels. Throws InputError unless the image has three axes (further ones of length 1), none
/// empty, and at most kMaxVoxels.
std::size_t checked_num_voxels(const std::string& path, const std::vector<int>& size);

/// Throws InputError where voxels that take `bytes` while they are read take more than `most_bytes`.
void check_room(const std::string& path, std::uint64_t bytes, std::uint64_t most_bytes);

/// Bytes of all voxels, checked as above before memory is asked for. Throws InputError where these and their
/// labels take more than `most_bytes` while they are read.
std::size_t checked_num_bytes(const RawImage& raw, std::uint64_t most_bytes);

/// The voxel spacing, mm. Axes that are orthogonal but for the rounding of the file's header are made exactly
/// so, in place. Throws InputError on an affine that is singular, not finite, or of voxels out of all
/// proportion.
std::array<double, 3> checked_spacing(const std::string& path, std::array<double, 12>& voxel_to_ras);

/// Throws InputError where world coordinates cannot tell a millionth of a voxel apart.
void check_distance(const std::string& path, const std::vector<int>& size,
                    const std::array<double, 12>& voxel_to_ras);

}  // namespace podm
