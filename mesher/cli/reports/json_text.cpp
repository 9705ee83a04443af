#include "cli/reports/json_text.h"

#include <nlohmann/json.hpp>

namespace podm::cli {

std::string json_line(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

nlohmann::ordered_json affine_rows(const LabelImage& image) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::size_t row = 0; row < 3; ++row) {
    const double* entry = &image.voxel_to_ras[4 * row];
    rows.push_back({entry[0], entry[1], entry[2], entry[3]});
  }
  return rows;
}

}  // namespace podm::cli
