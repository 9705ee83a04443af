// Which input a run had, by hash.
#pragma once

#include <string>

#include "cli/options/options.h"
#include "podm/label_image.h"

namespace podm::cli {

/// Lower-case hexadecimal SHA-256 of the file's bytes; of the voxels' label indices, in memory order, for a
/// phantom or an array, which have no file.
std::string input_sha256(const ImageArguments& arguments, const LabelImage& image);
/// Of a file's bytes. Throws InputError.
std::string file_sha256(const std::string& path);

}  // namespace podm::cli
