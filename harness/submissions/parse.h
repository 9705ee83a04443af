// Reads JSON of unknown origin.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "rows/fields.h"

namespace podm::bench {

/// Returns discarded JSON for a text that is not JSON, or that nests deeper than any row: copies of deeper
/// JSON could exhaust the stack.
inline Json parse_untrusted(const std::string& text) {
  constexpr int kMostDepth = 30;
  bool is_too_deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, const Json&) {
    is_too_deep = is_too_deep || depth > kMostDepth;
    return !is_too_deep;
  };
  Json json = Json::parse(text, watch, false);
  return is_too_deep ? Json(Json::value_t::discarded) : json;
}

}  // namespace podm::bench
