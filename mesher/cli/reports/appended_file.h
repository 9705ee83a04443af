// Appends lines to a file to which other processes may append as well.
#pragma once

#include <string>

namespace podm::cli {

class AppendedFile {
 public:
  /// Throws InputError unless a line can be appended to `path`, or a new file can be made there. Changes
  /// nothing. A device or a pipe, which must have a reader, is opened now, because its reader may be gone
  /// later.
  explicit AppendedFile(const std::string& path);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  /// Appends all of `line` or nothing. Waits while another process appends. Throws InputError that names the
  /// file and the fault.
  void append(const std::string& line);

 private:
  std::string path_;
  int stream_ = -1;  // the device or pipe
};

}  // namespace podm::cli
