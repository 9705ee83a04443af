// One reader a format family; read_image.cpp picks.
#pragma once

#include <string>
#include <vector>

#include "image/raw_image.h"

namespace podm {

/// Throws InputError unless `path` is a regular file that is not empty.
void check_exists(const std::string& path);

/// The whole file, decompressed if its name ends in .gz. Throws InputError on a missing, unreadable or
/// truncated file.
std::vector<unsigned char> read_bytes(const std::string& path);

RawImage read_inr(const std::string& path);
/// NIfTI, NRRD and MetaImage through ITK.
RawImage read_with_itk(const std::string& path);
/// NIfTI that ITK 5.2 refuses because its directions are not orthonormal.
RawImage read_with_libnifti(const std::string& path);

/// Whether the name ends in .nii, .nii.gz, .hdr or .img.
bool is_nifti_name(const std::string& path);

}  // namespace podm
