#include <zlib.h>

#include <filesystem>
#include <memory>

#include "image/read_formats.h"

namespace podm {

void check_exists(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse(path, "no such file");
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "not a regular file");
  if (std::filesystem::file_size(path, error) == 0) refuse(path, "the file is empty");
}

std::vector<unsigned char> read_bytes(const std::string& path) {
  check_exists(path);
  // gzread passes plain files through; a truncated stream ends in an error, not in silence.
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) refuse(path, "cannot be opened");
  gzbuffer(file.get(), 1 << 18);
  std::vector<unsigned char> bytes;
  constexpr std::size_t kChunk = 1 << 22;
  while (true) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kChunk);
    const int got = gzread(file.get(), bytes.data() + before, kChunk);
    int code = Z_OK;
    const char* message = gzerror(file.get(), &code);
    if (got < 0 || (code != Z_OK && code != Z_STREAM_END)) {
      refuse(path, std::string("the compressed data are damaged or truncated (") + message + ")");
    }
    bytes.resize(before + static_cast<std::size_t>(got));
    if (static_cast<std::size_t>(got) < kChunk) return bytes;
  }
}

}  // namespace podm
