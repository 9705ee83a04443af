// The program's messages in the words of the Python package.
#pragma once

#include <string>

namespace podm::python {

/// Options are called by the keyword that stands for them: "--radius-of" is radius_of. Where to find the
/// program's help is left out.
std::string in_python_terms(const std::string& message);

}  // namespace podm::python
