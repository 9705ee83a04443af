// What XML files of every format need.
#pragma once

#include <string>

namespace podm {

/// `text` as it may stand in an attribute between double quotes.
std::string xml_escaped(const std::string& text);

}  // namespace podm
