// Reads the bytes of a file from an offset on, inflated if they are compressed. A read gives all bytes asked
// for or throws.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace podm::verify {

enum class Compression {
  kNone,
  kStream,    ///< one zlib or gzip stream; bytes after it are ignored
  kIfGzipped  ///< gzip if the first bytes are gzip's
};

class ByteSource {
 public:
  /// All members throw InputError "path: fault". `path` is the image's file; `file` is the file that holds
  /// the bytes.
  ByteSource(const std::string& path, const std::string& file, std::uint64_t offset, Compression compression);

  /// Reads exactly `size` bytes.
  void read(void* bytes, std::size_t size);
  void skip(std::uint64_t size);
  /// Throws unless every byte has been read and the stream's checksum holds.
  void expect_end();
  /// Throws if the file cannot hold `size` bytes even at deflate's best ratio. Call it before allocating
  /// them.
  void expect_room_for(std::uint64_t size) const;
  /// Returns the compressed bytes of the stream, once expect_end() has returned; 0 if it is not compressed.
  std::uint64_t compressed_bytes() const { return stream_ ? stream_->total_in : 0; }

 private:
  struct End {
    void operator()(z_stream* stream) const {
      inflateEnd(stream);
      delete stream;
    }
  };
  std::size_t read_some(void* bytes, std::size_t size);
  std::size_t inflate_some(void* bytes, std::size_t size);

  std::string path_;
  std::ifstream file_;
  std::uint64_t most_bytes_ = 0;
  std::unique_ptr<z_stream, End> stream_;  // null: not compressed
  bool has_members_ = false;               // gzip: streams may follow one another
  std::vector<unsigned char> compressed_;
  bool is_finished_ = false;  // the stream has ended
};

/// Returns the size of the regular file `file`, part of the image `path`. Throws InputError if it is missing,
/// not regular or empty.
std::uint64_t file_bytes(const std::string& path, const std::string& file);

}  // namespace podm::verify
