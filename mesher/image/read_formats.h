// One reader a format family, and who picks among them. Each throws InputError naming the file and the fault,
// also where the voxels and their labels would take more than `most_bytes`.
#pragma once

#include <cstdint>
#include <string>

#include "image/raw_image.h"

namespace podm {

RawImage read_inr(const std::string& path, std::uint64_t most_bytes);
/// NIfTI-1 in one file, with any affine: the sform if there is one, else the qform, else the voxel sizes.
RawImage read_nifti(const std::string& path, std::uint64_t most_bytes);
/// NRRD and MetaImage, their voxels in the same file or in one beside it.
RawImage read_with_itk(const std::string& path, std::uint64_t most_bytes);

/// By the reader of the format that the file's name tells.
RawImage read_raw(const std::string& path, std::uint64_t most_bytes);

}  // namespace podm
