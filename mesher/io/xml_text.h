// Functions for XML files of every format.
#pragma once

#include <string>

namespace podm {

/// Returns `text` escaped for an attribute between double quotes.
std::string xml_escaped(const std::string& text);

}  // namespace podm
