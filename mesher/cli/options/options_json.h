// The declared options of podm mesh as data, for the programs that build on them: podm-bench, the Python
// package, the documentation.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/options/options.h"

namespace podm::cli {

/// A JSON array with one object per option: `name`, `keyword` (in Python), `key` (in experiments and
/// records), `kind`, `choices`, `type`, `default`, `unset`, `least`, `most`, `quantity`, `group`, `help`,
/// `uses`, `not_on_ranks`, `needs`, `excludes`.
std::string options_json();

/// Returns the values of the options that Python and records have, by their keys in records.
nlohmann::ordered_json option_values(const MeshCommand& command);

}  // namespace podm::cli
