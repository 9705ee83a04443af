// An image file whose voxels need not be read as a whole: they are integers, and not compressed.
#pragma once

#include <memory>
#include <string>

#include "files/positioned_file.h"
#include "image/read_formats.h"
#include "image/voxel.h"

namespace podm {

class VoxelFile {
 public:
  /// Null if the format, the type or the layers of the image require that it is read as a whole. Throws
  /// InputError that names the file and the fault.
  static std::shared_ptr<const VoxelFile> open(const std::string& path);

  const std::string& path() const { return head_.image.path; }
  /// Size, spacing and affine, without labels and voxels.
  const LabelImage& grid() const { return grid_; }
  VoxelType type() const { return head_.image.type; }

  /// Returns the voxels from `low` to `high`, which is excluded, labelled by value. Any thread may call it.
  /// Throws InputError if a voxel is no label or cannot be read.
  LabelImage read(const Voxel& low, const Voxel& high, std::size_t threads) const;

 private:
  explicit VoxelFile(ImageHead head);
  std::vector<unsigned char> read_bytes(const Voxel& low, const Voxel& high) const;

  ImageHead head_;
  LabelImage grid_;
  PositionedFile file_;
};

}  // namespace podm
