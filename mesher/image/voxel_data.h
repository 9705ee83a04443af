// Finds the voxels of a NRRD or MetaImage file and checks that they are complete. ITK does not check: it
// fills missing voxels with zeros or leaves them uninitialized.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace podm {

struct VoxelData {
  std::string path;  ///< of the image file, or of a file beside it
  std::uint64_t offset = 0;
  bool is_compressed = false;  ///< a zlib or gzip stream
  bool is_big_endian = false;
  std::string announced_bytes =
      {};  ///< of a compressed stream, as in the header; empty if the header has none
};

/// Read from the text header. Throw InputError naming `path` on a wrong magic, a missing end or an unknown
/// encoding.
VoxelData find_nrrd_voxels(const std::string& path);
VoxelData find_meta_voxels(const std::string& path);

/// Throws InputError naming `path` unless the data, decompressed, are exactly `needed` bytes.
void expect_voxel_bytes(const std::string& path, const VoxelData& data, std::uint64_t needed);

/// The `needed` bytes that a compressed stream contains. Throws as expect_voxel_bytes() does, and before it
/// allocates memory that the file cannot fill. The stream ends where zlib finds its end. If the header
/// announces another number of bytes, `warnings` gets a sentence.
std::vector<unsigned char> decompressed_voxels(const std::string& path, const VoxelData& data,
                                               std::uint64_t needed, std::vector<std::string>& warnings);

}  // namespace podm
