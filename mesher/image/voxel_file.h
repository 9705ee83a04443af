// An image file whose voxels need not be read as a whole. They are integers. If they are compressed, they can
// be read from front to back only.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/positioned_file.h"
#include "image/input_file.h"
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
  bool is_compressed() const { return head_.voxels.is_compressed; }

  /// Returns the voxels from `low` to `high`, which is excluded, labelled by value. They must not be
  /// compressed. Any thread may call it. Throws InputError if a voxel is no label or cannot be read, or if
  /// the file has changed since it was opened.
  LabelImage read(const Voxel& low, const Voxel& high, std::size_t threads) const;

 private:
  friend class VoxelStream;
  explicit VoxelFile(ImageHead head);
  LabelImage labelled(const Voxel& low, const Voxel& high, std::vector<unsigned char> bytes,
                      std::size_t threads) const;
  std::vector<unsigned char> read_bytes(const Voxel& low, const Voxel& high) const;

  ImageHead head_;
  LabelImage grid_;
  std::optional<PositionedFile> file_;  // none if the voxels are compressed
};

/// Reads the slices of a compressed file from front to back.
class VoxelStream {
 public:
  /// Keeps the reference.
  explicit VoxelStream(const VoxelFile& file);
  /// Returns the slices from `low` to `high`, as VoxelFile::read(). Neither may be less than in earlier
  /// calls. Throws InputError, also if the file does not end after the last slice.
  LabelImage read(int low, int high, std::size_t threads);

 private:
  const VoxelFile& file_;
  InputFile stream_;
  const std::size_t slice_bytes_;
  int first_ = 0;                     // slice of the first of `bytes_`
  std::vector<unsigned char> bytes_;  // of the slices that the next call may need
};

}  // namespace podm
