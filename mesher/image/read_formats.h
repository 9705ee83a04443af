// One reader per format family, and the function that picks one. Each throws InputError naming the file and
// the fault, also if the voxels and their labels would take more than `most_bytes`.
#pragma once

#include <cstdint>
#include <string>

#include "image/raw_image.h"
#include "image/voxel_data.h"

namespace podm {

RawImage read_inr(const std::string& path, std::uint64_t most_bytes);
/// NIfTI-1 in one file, with any affine: the sform if there is one, otherwise the qform, otherwise the voxel
/// sizes.
RawImage read_nifti(const std::string& path, std::uint64_t most_bytes);
/// NRRD and MetaImage, with their voxels in the same file or in one beside it.
RawImage read_with_itk(const std::string& path, std::uint64_t most_bytes);

/// The header of an image, and the place of its voxels.
struct ImageHead {
  RawImage image;  ///< without voxels
  VoxelData voxels;
};
ImageHead read_nifti_head(const std::string& path);
ImageHead read_head_with_itk(const std::string& path);

/// Reads with the reader of the format that the file's name implies.
RawImage read_raw(const std::string& path, std::uint64_t most_bytes);

}  // namespace podm
