// Writes a file that appears whole or not at all. Until every byte is on the disk, its name is made of the
// file's name, the process and a number, like the mesher's temporary files: NAME.tmp12-0.
#pragma once

#include <string>
#include <string_view>

namespace podm::verify {

/// Writes the file. An older file of that name stays as it is until the new one is complete. If the program
/// ends before that, except by kill -9, the unfinished file is removed first. Unfinished files of killed
/// processes are removed here. Throws InputError.
void write_whole_file(const std::string& path, std::string_view text);

/// Throws InputError that names the path and the system's message.
[[noreturn]] void refuse_to_write(const std::string& path, int error_number);

}  // namespace podm::verify
