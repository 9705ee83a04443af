// Which input a run had, by hash.
#pragma once

#include <string>

#include "podm/label_image.h"

namespace podm::cli {

/// Lower-case hexadecimal SHA-256 of the file's bytes; of the voxels' label indices, in memory order, for a
/// phantom, which has no file.
std::string input_sha256(const std::string& path, const LabelImage& image);
/// Of a file's bytes. Throws InputError.
std::string file_sha256(const std::string& path);

}  // namespace podm::cli
