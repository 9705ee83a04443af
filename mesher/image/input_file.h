// A file read front to back, gunzipped where it is gzipped, that never gives fewer bytes than asked for.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace podm {

/// The best ratio of deflate.
inline constexpr std::uint64_t kBestCompression = 1032;

/// Bytes of a regular file. Throws InputError: missing, not a file, empty.
std::uint64_t file_bytes(const std::string& path);

class InputFile {
 public:
  /// Every member throws InputError naming `path` and the fault.
  explicit InputFile(const std::string& path);

  /// Reads exactly `size` bytes; a file that ends before is truncated.
  void read(void* bytes, std::size_t size);
  void skip(std::uint64_t size);
  /// Throws unless every byte has been read and, of a gzipped file, the checksum holds.
  void expect_end();
  /// Throws if the file cannot hold `size` bytes even at the best compression: ask before allocating them.
  void expect_room_for(std::uint64_t size) const;

 private:
  struct Close {
    void operator()(gzFile_s* file) const { gzclose_r(file); }
  };

  std::string path_;
  std::uint64_t most_bytes_ = 0;
  std::unique_ptr<gzFile_s, Close> file_;
};

}  // namespace podm
