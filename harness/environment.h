// The machine, its state and the build: what a measurement needs told beside it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace podm::bench {

/// As they are now; what cannot be known reads "unavailable: why". Uses `scratch_folder`, which must exist.
nlohmann::ordered_json environment(const std::string& scratch_folder);

}  // namespace podm::bench
