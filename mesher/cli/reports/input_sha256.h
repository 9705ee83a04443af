// Identifies the input of a run by a hash.
#pragma once

#include <string>

#include "cli/options/options.h"
#include "podm/label_image.h"

namespace podm::cli {

/// Returns the lower-case hexadecimal SHA-256 of the file's bytes. For a phantom or an array, which have no
/// file, returns that of the voxels' label indices in memory order.
std::string input_sha256(const ImageArguments& arguments, const LabelImage& image);
/// Returns the SHA-256 of a file's bytes. Throws InputError.
std::string file_sha256(const std::string& path);

}  // namespace podm::cli
