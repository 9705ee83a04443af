#include "image/input_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "image/raw_image.h"

namespace podm {

std::uint64_t file_bytes(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) refuse(path, "no such file");
  if (!std::filesystem::is_regular_file(status)) refuse(path, "not a regular file");
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) refuse(path, "cannot be opened (" + error.message() + ")");
  if (bytes == 0) refuse(path, "the file is empty");
  return bytes;
}

InputFile::InputFile(const std::string& path) : path_(path) {
  const std::uint64_t bytes = file_bytes(path);
  file_.reset(gzopen(path.c_str(), "rb"));
  if (!file_) refuse(path, "cannot be opened for reading");
  gzbuffer(file_.get(), 1 << 18);
  most_bytes_ = gzdirect(file_.get()) ? bytes : bytes * kBestCompression;
}

void InputFile::read(void* bytes, std::size_t size) {
  constexpr std::size_t kMostAtOnce = 1 << 30;  // zlib counts in int
  auto* to = static_cast<char*>(bytes);
  while (size > 0) {
    const int got = gzread(file_.get(), to, static_cast<unsigned>(std::min(size, kMostAtOnce)));
    if (got <= 0) {
      int code = Z_OK;
      const std::string detail = gzerror(file_.get(), &code);
      if (code == Z_OK || code == Z_BUF_ERROR || code == Z_STREAM_END)
        refuse(path_, "the file is truncated (it ends " + std::to_string(size) + " bytes early)");
      refuse(path_, "the file is damaged (" + detail + ")");
    }
    to += got;
    size -= static_cast<std::size_t>(got);
  }
}

void InputFile::skip(std::uint64_t size) {
  std::array<char, 1 << 14> unused;
  while (size > 0) {
    const std::size_t part = std::min<std::uint64_t>(size, unused.size());
    read(unused.data(), part);
    size -= part;
  }
}

void InputFile::expect_end() {
  char next = 0;
  if (gzread(file_.get(), &next, 1) > 0) refuse(path_, "the file holds more data than its header announces");
  int code = Z_OK;
  const std::string detail = gzerror(file_.get(), &code);
  if (code == Z_BUF_ERROR) refuse(path_, "the file is truncated (its gzip stream has no end)");
  if (code != Z_OK && code != Z_STREAM_END) refuse(path_, "the file is damaged (" + detail + ")");
}

void InputFile::expect_room_for(std::uint64_t size) const {
  if (size > most_bytes_)
    refuse(path_,
           "the file is truncated (its header announces " + std::to_string(size) + " bytes of voxels)");
}

}  // namespace podm
