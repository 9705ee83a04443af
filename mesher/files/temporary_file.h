// A new file beside another, whose name it takes once every byte is on the disk; else it goes away. A process
// that is killed leaves it behind: the next that writes the same file removes it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace podm {

/// Throws InputError: "cannot write PATH: " and what the system says.
[[noreturn]] void fail_to_write(const std::string& path, int error_number);

class TemporaryFile {
 public:
  /// Beside `path`, named after it, the process and a number. Removes what processes that are gone have left
  /// of `path`. Every member fails by fail_to_write().
  explicit TemporaryFile(const std::string& path);
  /// Removes the file unless it is published.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return descriptor_; }
  void write(const char* bytes, std::size_t size);
  /// Brings the bytes to the disk. Nothing may be written afterwards.
  void close();

  /// Closes the files and gives them their names: none before all are on the disk, and a signal that ends the
  /// program comes before the first or after the last.
  static void publish(std::span<TemporaryFile* const> files);

 private:
  void sync_folder() const;

  std::string path_;       // as the caller wrote it, for messages
  std::string target_;     // path_ with symbolic links followed: a link is kept, its target replaced
  std::string temporary_;  // empty once published
  int descriptor_ = -1;
};

}  // namespace podm
