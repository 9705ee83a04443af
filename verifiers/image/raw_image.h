// An image as its file stores it, which the reader of each format returns, and the checks that readers share.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace podm::verify {

class ByteSource;

enum class VoxelType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kUint64, kInt64, kFloat, kDouble };

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
inline std::size_t bytes_of(VoxelType type) {
  return with_voxel_type(type, [](auto voxel) { return sizeof voxel; });
}

/// A segment of a segmentation of 3D Slicer.
struct Segment {
  std::uint32_t stored = 0;  ///< its value in the voxels of its layer
  std::uint32_t label = 0;   ///< its value in the image
  std::size_t layer = 0;
};

struct RawImage {
  std::vector<std::int64_t> size;  ///< voxels per axis of the file, less that of the layers
  VoxelType type = VoxelType::kUint8;
  bool is_swapped = false;                 ///< voxels are not in this machine's byte order
  double slope = 1, intercept = 0;         ///< a value is slope * voxel + intercept
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, mm
  std::vector<unsigned char> bytes;        ///< voxels, x fastest
  std::size_t num_layers = 1;              ///< values per voxel
  std::size_t layer_axis = 0;              ///< axes of `size` before that of the layers
  std::vector<Segment> segments = {};      ///< of several layers; may be there if there is one layer
  std::vector<std::string> warnings = {};  ///< as in Image
};

/// Throws InputError "path: fault".
[[noreturn]] void refuse(const std::string& path, const std::string& fault);

/// Fills raw.bytes with all bytes left in the source. Throws InputError unless size and type are those of a
/// 3-D image (further axes of length 1) and the source holds exactly the bytes of all layers. Memory is
/// allocated only if the file can hold that much.
void read_voxels(const std::string& path, RawImage& raw, ByteSource& source);

/// Returns the voxel spacing, mm. An affine that is orthogonal up to the rounding of a header is made exactly
/// orthogonal, in place. Throws InputError if the affine is singular or not finite.
std::array<double, 3> orthogonalize_affine(const std::string& path, std::array<double, 12>& voxel_to_ras);

/// Calls use(number, value) for every voxel, with the value in the type of the file.
template <class Use>
void for_each_voxel(RawImage& raw, const Use& use) {
  with_voxel_type(raw.type, [&]<class Voxel>(Voxel) {
    for (std::size_t i = 0; i < raw.bytes.size() / sizeof(Voxel); ++i) {
      unsigned char* const bytes = raw.bytes.data() + i * sizeof(Voxel);
      if (raw.is_swapped) std::reverse(bytes, bytes + sizeof(Voxel));
      Voxel voxel;
      std::memcpy(&voxel, bytes, sizeof voxel);
      use(i, voxel);
    }
  });
}

RawImage read_raw(const std::string& path);    ///< chooses the reader by the file's name
RawImage read_inr(const std::string& path);    ///< INRIMAGE-4
RawImage read_nifti(const std::string& path);  ///< NIfTI-1 in one file, any affine
RawImage read_nrrd(const std::string& path);   ///< attached or detached, raw or gzip
RawImage read_meta(const std::string& path);   ///< attached or detached, raw or zlib

}  // namespace podm::verify
