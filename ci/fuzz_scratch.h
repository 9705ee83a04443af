// What fuzz targets share: a folder for the files that a reader is given, and how a broken promise is told.
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

/// A promise of the reader; libFuzzer takes an abort for a finding.
inline void check(bool holds) {
  if (!holds) std::abort();
}

/// A folder in $TMPDIR, for which ci/fuzz.sh takes memory. It is gone when the process ends.
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

  /// Its path; an older file of the name is lost. Without a stream: a hundred thousand files a second.
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
