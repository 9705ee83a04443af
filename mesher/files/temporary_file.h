// A new file beside another file. It takes the other file's name once every byte is on the disk; otherwise it
// is removed. A process that is killed leaves it behind, and the next process that writes the same file
// removes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "files/temporary_name.h"

namespace podm {

/// Throws InputError: "cannot write PATH: " and the system's message.
[[noreturn]] void fail_to_write(const std::string& path, int error_number);

class TemporaryFile {
 public:
  /// Makes the file beside `path`. Every member reports failure through fail_to_write().
  explicit TemporaryFile(const std::string& path);
  /// Removes the file unless it is published.
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Returns a further descriptor of the file, for a writer that closes it. finish() keeps one of its own.
  int new_descriptor() const;
  /// Returns the path of the bytes until publish(), for writers that need a name.
  const std::string& temporary_path() const { return temporary_.path; }
  void write(const char* bytes, std::size_t size);
  /// Writes the bytes to the disk. Nothing may be written afterwards.
  void finish();

  /// Finishes the files and gives them their names. No file gets its name before all are on the disk, and a
  /// signal that ends the program takes effect before the first renaming or after the last.
  static void publish(std::span<TemporaryFile* const> files);

 private:
  void sync_folder() const;

  std::string path_;     // as given by the caller, for messages
  std::string target_;   // path_ with symbolic links followed: a link is kept, its target replaced
  Temporary temporary_;  // without a path once published
  bool is_finished_ = false;
};

/// A file that another process may have made, and that several processes write at once, each at its own
/// offsets.
class SharedFile {
 public:
  /// Opens the existing file `file`. Every member reports failure through fail_to_write(path).
  SharedFile(const std::string& file, const std::string& path);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  void write(std::uint64_t offset, std::string_view bytes);
  /// Writes the bytes to the disk. Nothing may be written afterwards.
  void finish();

 private:
  const std::string path_;
  const int descriptor_;
};

/// A folder beside a file. It is removed with its contents whenever a temporary file of that file would be.
class TemporaryFolder {
 public:
  /// Makes the folder beside `path`. Reports failure through fail_to_write().
  explicit TemporaryFolder(const std::string& path);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const char* name) const { return temporary_.path + "/" + name; }

 private:
  Temporary temporary_;
};

}  // namespace podm
