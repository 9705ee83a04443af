#include "image/byte_source.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <system_error>

#include "image/raw_image.h"

namespace podm::verify {

namespace {

constexpr std::uint64_t kBestRatio = 1032;  // deflate's best ratio
constexpr int kZlibOrGzip = 32 + MAX_WBITS;

}  // namespace

std::uint64_t file_bytes(const std::string& path, const std::string& file) {
  std::error_code error;
  const std::string name = file == path ? "" : "'" + file + "': ";
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse(path, name + "no such file");
  if (!std::filesystem::is_regular_file(status)) refuse(path, name + "not a regular file");
  const std::uint64_t bytes = std::filesystem::file_size(file, error);
  if (error) refuse(path, name + "cannot be opened (" + error.message() + ")");
  if (bytes == 0) refuse(path, name + "the file is empty");
  return bytes;
}

ByteSource::ByteSource(const std::string& path, const std::string& file, std::uint64_t offset,
                       Compression compression)
    : path_(path), file_(file, std::ios::binary) {
  const std::uint64_t bytes = file_bytes(path, file);
  if (!file_) refuse(path, "cannot be opened for reading");
  const auto start = static_cast<std::streamoff>(std::min(offset, bytes));
  file_.seekg(start);
  most_bytes_ = bytes - std::min(offset, bytes);
  if (compression == Compression::kIfGzipped) {
    std::array<char, 2> magic{};
    file_.read(magic.data(), magic.size());
    file_.clear();
    file_.seekg(start);
    if (magic != std::array<char, 2>{'\x1f', '\x8b'}) compression = Compression::kNone;
  }
  if (compression == Compression::kNone) return;
  has_members_ = compression == Compression::kIfGzipped;
  most_bytes_ *= kBestRatio;
  compressed_.resize(1 << 18);
  stream_.reset(new z_stream{});
  if (inflateInit2(stream_.get(), kZlibOrGzip) != Z_OK) refuse(path, "zlib does not start");
}

void ByteSource::read(void* bytes, std::size_t size) {
  auto* to = static_cast<unsigned char*>(bytes);
  while (size > 0) {
    const std::size_t got = read_some(to, size);
    if (got == 0) refuse(path_, "the file is truncated (it ends " + std::to_string(size) + " bytes early)");
    to += got;
    size -= got;
  }
}

void ByteSource::skip(std::uint64_t size) {
  std::array<char, 1 << 14> unused;
  while (size > 0) {
    const std::size_t part = std::min<std::uint64_t>(size, unused.size());
    read(unused.data(), part);
    size -= part;
  }
}

void ByteSource::expect_end() {
  char next = 0;
  if (read_some(&next, 1) > 0) refuse(path_, "the file holds more data than its header announces");
  if (stream_ && !is_finished_) refuse(path_, "the file is truncated (its compressed voxels have no end)");
}

void ByteSource::expect_room_for(std::uint64_t size) const {
  if (size > most_bytes_)
    refuse(path_,
           "the file is truncated (its header announces " + std::to_string(size) + " bytes of voxels)");
}

std::size_t ByteSource::read_some(void* bytes, std::size_t size) {
  if (stream_) return inflate_some(bytes, size);
  file_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(size));
  return static_cast<std::size_t>(file_.gcount());
}

// A gzip file may have several members: if bytes are left after the end of one, another begins there.
std::size_t ByteSource::inflate_some(void* bytes, std::size_t size) {
  stream_->next_out = static_cast<Bytef*>(bytes);
  const auto room = static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
  stream_->avail_out = room;
  while (stream_->avail_out == room) {
    if (is_finished_ && !has_members_) return 0;
    if (stream_->avail_in == 0) {
      file_.read(reinterpret_cast<char*>(compressed_.data()),
                 static_cast<std::streamsize>(compressed_.size()));
      stream_->next_in = compressed_.data();
      stream_->avail_in = static_cast<uInt>(file_.gcount());
      if (stream_->avail_in == 0) return 0;
    }
    if (is_finished_) {
      inflateReset(stream_.get());
      is_finished_ = false;
    }
    const int code = inflate(stream_.get(), Z_NO_FLUSH);
    if (code == Z_STREAM_END)
      is_finished_ = true;
    else if (code != Z_OK && code != Z_BUF_ERROR)
      refuse(path_, "the file is damaged (" + std::string(stream_->msg ? stream_->msg : "zlib") + ")");
  }
  return room - stream_->avail_out;
}

}  // namespace podm::verify
