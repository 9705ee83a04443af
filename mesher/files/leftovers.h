// The things that this process has made and must not leave behind: temporary files and folders, and programs
// that it started. Code that ends the process because of a signal removes them first.
#pragma once

#include <sys/types.h>

#include <mutex>
#include <string>

namespace podm {

/// Holds the leftovers: while an object lives, no other thread holds them, so remove_leftovers_for_good()
/// cannot end the process. Hold them only for a few system calls that do not wait for other processes; these
/// calls are then done all or not at all.
class HeldLeftovers {
 public:
  HeldLeftovers();
  /// Must be called before the path is made; a path that does not exist yet may be removed too.
  void add(const std::string& path);
  /// Must be called when the path is removed, or has become something that stays.
  void drop(const std::string& path);
  bool has(const std::string& path) const;

  /// Adds a child process, or drops it. The caller holds the leftovers from before its start until it is
  /// added, and from before the wait for its end until it is dropped.
  void add_child(pid_t child);
  void drop_child(pid_t child);

 private:
  std::unique_lock<std::mutex> lock_;
};

/// Kills the children, removes the paths, folders with their contents, and holds the leftovers from then on:
/// the calling thread ends the process next. Another thread that makes, renames or removes such a file waits
/// meanwhile. Gives up within a second if another thread holds the leftovers and the system does not let it
/// continue, for example on a dead disk.
void remove_leftovers_for_good() noexcept;

/// Removes the file or folder with that name; does not follow links.
void remove_file_or_folder(const std::string& path) noexcept;

}  // namespace podm
