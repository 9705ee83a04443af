// One reader per format family, and the function that picks one. Each throws InputError naming the file and
// the fault, also if the voxels and their labels would take more than `most_bytes`.
#pragma once

#include <cstdint>
#include <string>

#include "image/raw_image.h"

namespace podm {

RawImage read_inr(const std::string& path, std::uint64_t most_bytes);
/// NIfTI-1 in one file, with any affine: the sform if there is one, otherwise the qform, otherwise the voxel
/// sizes.
RawImage read_nifti(const std::string& path, std::uint64_t most_bytes);
/// NRRD and MetaImage, with their voxels in the same file or in one beside it.
RawImage read_with_itk(const std::string& path, std::uint64_t most_bytes);

/// Reads with the reader of the format that the file's name implies.
RawImage read_raw(const std::string& path, std::uint64_t most_bytes);

}  // namespace podm
