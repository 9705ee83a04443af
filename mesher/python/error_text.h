// Conversion of the program's messages to the terms of the Python package.
#pragma once

#include <string>

namespace podm::python {

/// Replaces options by their keywords: "--radius-of" becomes radius_of. Removes references to the program's
/// help.
std::string in_python_terms(const std::string& message);

}  // namespace podm::python
