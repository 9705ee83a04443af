// Data for standard output, where a full disk or a closed pipe must not pass unseen.
#pragma once

#include <string_view>

namespace podm::cli {

/// Throws InputError if not every byte was accepted.
void write_standard_output(std::string_view text);

}  // namespace podm::cli
