// Where the voxels of a NRRD or MetaImage file lie, and whether all of them are there. ITK does not check:
// it fills what is missing with zeros or leaves it uninitialized.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace podm {

struct VoxelData {
  std::string path;  ///< of the image file, or of one beside it
  std::uint64_t offset = 0;
  bool is_compressed = false;  ///< a zlib or gzip stream
  bool is_big_endian = false;  ///< told of MetaImage only
  std::string announced_bytes =
      {};  ///< of a compressed stream, as the header has it; empty: it does not tell
};

/// Read from the text header. Throw InputError naming `path`: wrong magic, no end, an encoding not known.
VoxelData find_nrrd_voxels(const std::string& path);
VoxelData find_meta_voxels(const std::string& path);

/// Throws InputError naming `path` unless the data, decompressed, are exactly `needed` bytes.
void expect_voxel_bytes(const std::string& path, const VoxelData& data, std::uint64_t needed);

/// The `needed` bytes that a compressed stream makes; throws as expect_voxel_bytes() does, and before it asks
/// for memory that the file cannot fill. The stream ends where zlib finds its end: `warnings` gets a sentence
/// when the header announces another number of bytes.
std::vector<unsigned char> decompressed_voxels(const std::string& path, const VoxelData& data,
                                               std::uint64_t needed, std::vector<std::string>& warnings);

}  // namespace podm
