// A file that is read front to back, and gunzipped if it is gzipped. A read never returns fewer bytes than
// requested.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace podm {

/// The best compression ratio of deflate.
inline constexpr std::uint64_t kBestCompression = 1032;

/// The size of a regular file in bytes. Throws InputError if the file is missing, not a regular file or
/// empty.
std::uint64_t file_bytes(const std::string& path);

class InputFile {
 public:
  /// Every member throws InputError naming `path` and the fault.
  explicit InputFile(const std::string& path);

  bool is_compressed() const { return gzdirect(file_.get()) == 0; }
  /// Reads exactly `size` bytes. A file that ends before is refused as truncated.
  void read(void* bytes, std::size_t size);
  void skip(std::uint64_t size);
  /// Throws unless every byte has been read and, for a gzipped file, the checksum holds.
  void expect_end();
  /// Throws if the file cannot contain `size` bytes even at the best compression. To be called before the
  /// bytes are allocated.
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
