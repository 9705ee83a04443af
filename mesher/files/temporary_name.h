// How temporaries are named: after their target, the process and a number. The next process that writes the
// target tells by their locks which are still in use, and removes the others.
#pragma once

#include <string>

namespace podm {

struct Temporary {
  std::string path;      // among the leftovers
  int descriptor = -1;   // locked, where the file system has locks
  int error_number = 0;  // why there is none
};

/// A new file or folder beside `target`: `make` makes it under the path it is given and returns a descriptor
/// of it, or -1 with errno. Removes what processes that are gone have left of `target`.
Temporary make_temporary(const std::string& target, int (*make)(const char* path));

/// The folder that `path` is in, with the slash at its end; empty: the working folder.
std::string folder_of(const std::string& path);

}  // namespace podm
