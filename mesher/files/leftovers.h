// What this process has made and must not leave behind: temporary files and folders, programs that it
// started. Whoever ends it because of a signal removes them first.
#pragma once

#include <sys/types.h>

#include <mutex>
#include <string>

namespace podm {

/// The leftovers, held: as long as one lives no other thread holds them, so that the process does not end by
/// remove_leftovers_for_good(). They are to be held for a few system calls that do not wait for others; these
/// are then done all or not at all.
class HeldLeftovers {
 public:
  HeldLeftovers();
  /// Must come before the path is made; what is not there yet may be removed too.
  void add(const std::string& path);
  /// It is gone, or has become something that stays.
  void drop(const std::string& path);
  bool has(const std::string& path) const;

  /// A child process, added and dropped while held since before it is started and until it is waited for.
  void add_child(pid_t child);
  void drop_child(pid_t child);

 private:
  std::unique_lock<std::mutex> lock_;
};

/// Kills the children, removes the paths, folders with what is in them, and holds all ever after: the thread
/// that calls it ends the process next. Another that makes, renames or removes such a file waits meanwhile.
/// Gives up within a second where another thread holds them that the system does not let go on, as a dead
/// disk does.
void remove_leftovers_for_good() noexcept;

/// Removes whatever is there under that name; links are not followed.
void remove_file_or_folder(const std::string& path) noexcept;

}  // namespace podm
