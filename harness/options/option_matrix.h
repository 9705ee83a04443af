// The options of `podm mesh` that an experiment sets, and the product of options given as arrays.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "options/option_keys.h"
#include "runtime/toml_section.h"

namespace podm::bench {

/// One member of the product.
struct Variant {
  std::string suffix;              ///< ",key=value" of each key that the file gives as an array
  nlohmann::ordered_json options;  ///< by key of the experiment's file; `threads` is always present
};

/// Returns the product of the options in `section`. The option that comes first in the table of
/// experiments/README.md varies slowest. A topology is a file relative to `folder`.
std::vector<Variant> read_matrix(TomlSection& section, const std::string& folder);

/// Returns the options as `podm mesh` takes them: radius_mm = 2 becomes "--radius", "2"; true becomes the
/// bare option; false is left out. Options of the harness (mesher, schedule, replay, fidelity, image_grows,
/// solve, copies, counters, measure, ranks, carrier) are left out.
std::vector<std::string> mesher_arguments(const nlohmann::ordered_json& options);

/// Returns `value` as it appears in the name of a trial, with letters, digits and . _ - only.
std::string in_name(const nlohmann::ordered_json& value);

}  // namespace podm::bench
