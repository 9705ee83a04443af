// An image as its file stores it, what every format's reader gives, and the checks they share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace podm::verify {

class ByteSource;

enum class VoxelType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kUint64, kInt64, kFloat, kDouble };

std::size_t bytes_of(VoxelType type);

struct RawImage {
  std::vector<std::int64_t> size;  ///< voxels per axis, as many axes as the file has
  VoxelType type = VoxelType::kUint8;
  bool is_swapped = false;                 ///< voxels are in the byte order that is not this machine's
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, mm
  std::vector<unsigned char> bytes;        ///< voxels, x fastest
  std::vector<std::string> warnings = {};  ///< of Image
};

/// Throws InputError "path: fault".
[[noreturn]] void refuse(const std::string& path, const std::string& fault);

/// Fills raw.bytes with all that is left of the source. Throws InputError unless size and type are those of a
/// 3-D image (further axes of length 1) and the source holds exactly its bytes; memory is asked for only
/// when the file can hold that much.
void read_voxels(const std::string& path, RawImage& raw, ByteSource& source);

RawImage read_inr(const std::string& path);    ///< INRIMAGE-4
RawImage read_nifti(const std::string& path);  ///< NIfTI-1 in one file, any affine
RawImage read_nrrd(const std::string& path);   ///< attached or detached, raw or gzip
RawImage read_meta(const std::string& path);   ///< attached or detached, raw or zlib

}  // namespace podm::verify
