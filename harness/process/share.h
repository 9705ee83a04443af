#pragma once

#include <string>

namespace podm::bench {

/// Returns the path of a file in the folder of this program.
std::string beside_this_program(const std::string& name);

/// Returns the path of a file that comes with podm-bench, in the build tree and in an installation.
std::string share_of_this_program(const std::string& name);

}  // namespace podm::bench
