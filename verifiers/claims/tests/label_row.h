// Access to a claim's details about one label.
#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "claim.h"

namespace podm::verify {

/// Returns the label's row of the table `labels`; throws std::out_of_range if it has none.
inline const nlohmann::json& row_of(const ClaimResult& result, LabelValue label) {
  for (const auto& row : result.details().at("labels"))
    if (row.at("label") == label) return row;
  throw std::out_of_range("no such label in the table");
}

}  // namespace podm::verify
