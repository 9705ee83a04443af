// JSON output of the program.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "podm/label_image.h"

namespace podm::cli {

/// Returns one line, newline included. Replaces bytes that are not UTF-8, which file and label names may
/// contain.
std::string json_line(const nlohmann::ordered_json& value);

/// Returns the affine from voxel indices to RAS mm: three rows of four numbers.
nlohmann::ordered_json affine_rows(const LabelImage& image);

}  // namespace podm::cli
