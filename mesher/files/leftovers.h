// What this process has made and must not leave behind: temporary files and folders. Whoever ends it because
// of a signal removes them first.
#pragma once

#include <mutex>
#include <string>

namespace podm {

/// The paths, held: as long as one lives no other thread holds them, so that the process does not end by
/// remove_leftovers_for_good(). For a few system calls at a time, which are then done all or not at all.
class HeldLeftovers {
 public:
  HeldLeftovers();
  /// Before the path is made; what is not there yet may be removed too.
  void add(const std::string& path);
  /// It is gone, or has become something that stays.
  void drop(const std::string& path);
  bool has(const std::string& path) const;

 private:
  std::unique_lock<std::mutex> lock_;
};

/// Removes all of them, folders with what is in them, and holds them ever after: for the thread that ends the
/// process next. Another that makes, renames or removes such a file waits meanwhile.
void remove_leftovers_for_good() noexcept;

}  // namespace podm
