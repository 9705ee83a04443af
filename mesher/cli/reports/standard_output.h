// Output of data to standard output. A full disk or a closed pipe must not pass unnoticed.
#pragma once

#include <string_view>

namespace podm::cli {

/// Throws InputError if not every byte was accepted.
void write_standard_output(std::string_view text);

}  // namespace podm::cli
