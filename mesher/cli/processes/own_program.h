// The file of the running program, and whether a file is a program.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace podm::cli {

/// A path to the file of this program. It opens that file even if another one has taken its name.
inline constexpr const char* kOwnProgram = "/proc/self/exe";

inline std::filesystem::path folder_of_own_program() {
  return std::filesystem::read_symlink(kOwnProgram).parent_path();
}

inline bool can_be_run(const std::string& path) { return ::access(path.c_str(), X_OK) == 0; }

}  // namespace podm::cli
