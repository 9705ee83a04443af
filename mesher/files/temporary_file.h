// A new file beside another, whose name it takes once every byte is on the disk; else it goes away. A process
// that is killed leaves it behind: the next that writes the same file removes it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "files/temporary_name.h"

namespace podm {

/// Throws InputError: "cannot write PATH: " and what the system says.
[[noreturn]] void fail_to_write(const std::string& path, int error_number);

class TemporaryFile {
 public:
  /// Makes the file beside `path`. Every member fails by fail_to_write().
  explicit TemporaryFile(const std::string& path);
  /// Removes the file unless it is published.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return temporary_.descriptor; }
  /// Where the bytes are until publish(), for a writer that wants a name.
  const std::string& temporary_path() const { return temporary_.path; }
  void write(const char* bytes, std::size_t size);
  /// Brings the bytes to the disk. Nothing may be written afterwards.
  void finish();

  /// Finishes the files and gives them their names: none before all are on the disk, and a signal that ends
  /// the program comes before the first or after the last.
  static void publish(std::span<TemporaryFile* const> files);

 private:
  void sync_folder() const;

  std::string path_;     // as the caller wrote it, for messages
  std::string target_;   // path_ with symbolic links followed: a link is kept, its target replaced
  Temporary temporary_;  // without a path once published
  bool is_finished_ = false;
};

/// A folder beside a file that goes away with all it holds, and whenever a temporary file of it would.
class TemporaryFolder {
 public:
  /// Makes the folder beside `path`. Fails by fail_to_write().
  explicit TemporaryFolder(const std::string& path);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const char* name) const { return temporary_.path + "/" + name; }

 private:
  Temporary temporary_;
};

}  // namespace podm
