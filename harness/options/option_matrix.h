// The options of `podm mesh` that an experiment sets, and the product of options given as arrays.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "options/option_keys.h"
#include "process/usable_processors.h"
#include "runtime/toml_section.h"

namespace podm::bench {

/// One member of the product.
struct Variant {
  std::string suffix;              ///< ",key=value" of each key that the file gives as an array
  nlohmann::ordered_json options;  ///< by key of the experiment's file; `threads` is always present
};

/// Decides the values of options beside the section.
struct MatrixContext {
  std::string folder;                    ///< files are relative to it
  int processors = usable_processors();  ///< number of threads that "all" stands for
};

/// Returns the product of the options in `section`. The option that comes first in the table of
/// experiments/README.md varies slowest.
std::vector<Variant> read_matrix(TomlSection& section, const MatrixContext& context);

/// Returns the reason why `options` are not what a trial may have: an unknown key, a value of another type,
/// or a file, which a stranger must not name. Empty: there is none.
std::string fault_of_options(const nlohmann::ordered_json& options);

/// Returns the options as `podm mesh` takes them: radius_mm = 2 becomes "--radius", "2"; true becomes the
/// bare option; false is left out. Options of the harness (mesher, schedule, replay, fidelity, image_grows,
/// solve, copies, counters, measure, ranks, carrier) are left out.
std::vector<std::string> mesher_arguments(const nlohmann::ordered_json& options);

/// Returns `value` as it appears in the name of a trial, with letters, digits and . _ - only.
std::string in_name(const nlohmann::ordered_json& value);

}  // namespace podm::bench
