// An image as its file stores it, and the checks that all readers share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "podm/image_io.h"

namespace podm {

/// Calls use(Voxel()) for the C++ type of voxels.
template <class Use>
auto with_voxel_type(VoxelType type, const Use& use) {
  using AnyVoxel = std::variant<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                std::int32_t, std::uint64_t, std::int64_t, float, double>;
  constexpr AnyVoxel kVoxels[] = {std::uint8_t(),  std::int8_t(),  std::uint16_t(), std::int16_t(),
                                  std::uint32_t(), std::int32_t(), std::uint64_t(), std::int64_t(),
                                  float(),         double()};
  return std::visit(use, kVoxels[static_cast<std::size_t>(type)]);
}

std::size_t bytes_of(VoxelType type);

struct RawImage {
  std::string path;       ///< for messages
  std::vector<int> size;  ///< voxels per axis, for all axes of the file
  VoxelType type = VoxelType::kUint8;
  double slope = 1, intercept = 0;         ///< a value is slope * voxel + intercept
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, mm
  std::vector<unsigned char> bytes;        ///< voxels, x fastest, this machine's byte order
  std::size_t num_layers = 1;              ///< values per voxel, one behind the other
  std::vector<Segment> segments = {};      ///< of a segmentation of 3D Slicer; several layers have segments
  std::vector<std::string> warnings = {};  ///< are copied to the LabelImage
};

/// The memory layout of its voxels.
VoxelArray array_of(const RawImage& raw);

/// Reverses the byte order of values of `width` bytes.
void swap_bytes(std::vector<unsigned char>& bytes, std::size_t width);

/// Throws InputError "path: fault".
[[noreturn]] void refuse(const std::string& path, const std::string& fault);
/// Throws InputError "path: fault: voxel (i, j, k) is not ..."; `voxel` counts voxels, x fastest.
[[noreturn]] void refuse_voxel(const RawImage& raw, std::size_t voxel, const std::string& fault,
                               const std::string& what_it_is_not);

/// The number of voxels. Throws InputError unless the image has three axes (further axes must have length 1),
/// no axis is empty, and there are at most kMaxVoxels voxels.
std::size_t checked_num_voxels(const std::string& path, const std::vector<int>& size);

/// Throws InputError if `bytes`, the memory that the voxels take while they are read, exceeds `most_bytes`.
void check_room(const std::string& path, std::uint64_t bytes, std::uint64_t most_bytes);

/// The bytes of all voxels, checked as above before any memory is allocated. Throws InputError if the voxels
/// and their labels take more than `most_bytes` while they are read. Layers are first merged to labels of up
/// to four bytes.
std::size_t checked_num_bytes(const RawImage& raw, std::uint64_t most_bytes);

/// The voxel spacing, mm. Axes that are orthogonal except for the rounding of the file's header are made
/// exactly orthogonal, in place. Throws InputError if the affine is singular or not finite, or if a spacing
/// is not between 1e-30 and 1e30 mm.
std::array<double, 3> checked_spacing(const std::string& path, std::array<double, 12>& voxel_to_ras);

/// Throws InputError if world coordinates cannot resolve a millionth of a voxel.
void check_distance(const std::string& path, const std::vector<int>& size,
                    const std::array<double, 12>& voxel_to_ras);

}  // namespace podm
