// A lock on a folder that one process at a time writes. It ends with the process.
#pragma once

#include <string>

namespace podm {

class FolderLock {
 public:
  /// Makes the folder if there is none, and the file "lock" in it. On file systems without locks it protects
  /// nothing. Throws InputError that names the folder if another object has the lock, or if the folder cannot
  /// be written.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace podm
