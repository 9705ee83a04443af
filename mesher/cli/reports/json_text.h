// How the program writes JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "podm/label_image.h"

namespace podm::cli {

/// One line, newline included. Bytes that are not UTF-8, which file and label names may hold, are replaced.
std::string json_line(const nlohmann::ordered_json& value);

/// The affine from voxel indices to RAS mm: three rows of four numbers.
nlohmann::ordered_json affine_rows(const LabelImage& image);

}  // namespace podm::cli
