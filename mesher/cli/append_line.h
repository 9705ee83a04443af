// Appending a line to a file that other processes may append to as well.
#pragma once

#include <string>

namespace podm::cli {

/// Throws InputError unless a line can be appended to `path`, or a new file made there. Changes nothing.
void check_appendable(const std::string& path);

/// Appends all of `line` or nothing. Throws InputError naming the file and the fault.
void append_line(const std::string& path, const std::string& line);

}  // namespace podm::cli
