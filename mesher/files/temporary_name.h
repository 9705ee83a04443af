// The names of temporaries: the target, the process and a number. The next process that writes the target
// finds out by their locks which are still in use, and removes the others.
#pragma once

#include <functional>
#include <string>

namespace podm {

struct Temporary {
  std::string path;      // one of the leftovers
  int descriptor = -1;   // locked, where the file system has locks
  int error_number = 0;  // the reason if there is none
};

/// Makes a new file or folder beside `target`. `make` makes it under the given path and returns its
/// descriptor, or -1 with errno. Removes temporaries of `target` that ended processes have left.
Temporary make_temporary(const std::string& target, int (*make)(const char* path));

/// Removes temporaries in a folder that ended processes have left, if is_target() of their target's path is
/// true. `folder` is as folder_of() returns it.
void remove_old_temporaries(const std::string& folder,
                            const std::function<bool(const std::string& target)>& is_target);

/// Returns the folder that contains `path`, with the slash at its end; empty for the working folder.
std::string folder_of(const std::string& path);

}  // namespace podm
