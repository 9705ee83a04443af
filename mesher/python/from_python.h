// Python's values as values of options (podm/option.h). Each function throws InputError with the keyword and
// what is expected.
#pragma once

#include <pybind11/pybind11.h>

#include "cli/options/options.h"

namespace podm::python {

/// The options of a run from a dict of keywords; what is None keeps its default. `use`: kInPython or kInPlan.
/// Refuses unknown keywords, and options without or with others, as they are declared.
cli::MeshCommand command_of(const pybind11::dict& keywords, OptionUse use);

/// The version of Gmsh's format; nothing for None.
std::optional<GmshVersion> gmsh_version_of(const pybind11::object& value);

}  // namespace podm::python
