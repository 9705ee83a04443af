// Appending lines to a file that other processes may append to as well.
#pragma once

#include <string>

namespace podm::cli {

class AppendedFile {
 public:
  /// Throws InputError unless a line can be appended to `path`, or a new file made there. Changes nothing. A
  /// device or a pipe, which must have a reader, is opened now: another reader may come too late.
  explicit AppendedFile(const std::string& path);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  /// Appends all of `line` or nothing, once no other process does. Throws InputError naming the file and the
  /// fault.
  void append(const std::string& line);

 private:
  std::string path_;
  int stream_ = -1;  // the device or pipe
};

}  // namespace podm::cli
