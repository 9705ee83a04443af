// Where the voxels of a NRRD or MetaImage file lie, and whether all of them are there. ITK does not check:
// it fills what is missing with zeros or leaves it uninitialized.
#pragma once

#include <cstdint>
#include <string>

namespace podm {

struct VoxelData {
  std::string path;  ///< of the image file, or of one beside it
  std::uint64_t offset = 0;
  bool is_compressed = false;  ///< a zlib or gzip stream
};

/// Read from the text header. Throw InputError naming `path`: wrong magic, no end, an encoding not known.
VoxelData find_nrrd_voxels(const std::string& path);
VoxelData find_meta_voxels(const std::string& path);

/// Throws InputError naming `path` unless the data, decompressed, are exactly `needed` bytes.
void expect_voxel_bytes(const std::string& path, const VoxelData& data, std::uint64_t needed);

}  // namespace podm
