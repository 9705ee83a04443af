// A file that appears whole or not at all. Until every byte is on the disk it is called after the file, the
// process and a number, as the mesher's temporaries are: NAME.tmp12-0.
#pragma once

#include <string>
#include <string_view>

namespace podm::verify {

/// An older file of that name stays as it is until then. Whatever ends the program meanwhile, but for kill
/// -9, removes the unfinished file first; those of processes that were killed are removed here. Throws
/// InputError.
void write_whole_file(const std::string& path, std::string_view text);

/// Throws InputError that names the path and tells what the system says.
[[noreturn]] void refuse_to_write(const std::string& path, int error_number);

}  // namespace podm::verify
