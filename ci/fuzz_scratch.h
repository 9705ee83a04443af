// Shared by fuzz targets: a folder for the files that a reader is given, and a check that reports a broken
// promise.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace podm::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Checks a promise of the reader. libFuzzer reports an abort as a finding.
inline void check(bool holds) {
  if (!holds) std::abort();
}

/// A folder in $TMPDIR, which ci/fuzz.sh places in memory. It is removed when the process ends.
class ScratchFolder {
 public:
  ScratchFolder() : path_(std::filesystem::temp_directory_path() / "podm-fuzz-XXXXXX") {
    check(mkdtemp(path_.data()) != nullptr);
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string operator/(const char* name) const { return path_ + "/" + name; }

  /// Writes the file and returns its path. An existing file of that name is overwritten. No stream is used,
  /// because targets write a hundred thousand files per second.
  std::string write(const char* name, std::string_view bytes) const {
    std::string path = *this / name;
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    check(file >= 0 && ::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
    ::close(file);
    return path;
  }

 private:
  std::string path_;
};

}  // namespace podm::fuzz
