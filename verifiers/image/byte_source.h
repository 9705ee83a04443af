// The bytes of a file from some place on, inflated where they are compressed, never fewer than asked for.
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
  kStream,    ///< one zlib or gzip stream, whatever follows it
  kIfGzipped  ///< gzip where the first bytes say so
};

class ByteSource {
 public:
  /// All members throw InputError "path: fault"; `path` is the image's, `file` where the bytes lie.
  ByteSource(const std::string& path, const std::string& file, std::uint64_t offset, Compression compression);

  /// Reads exactly `size` bytes.
  void read(void* bytes, std::size_t size);
  void skip(std::uint64_t size);
  /// Throws unless every byte has been read and the stream's checksum holds.
  void expect_end();
  /// Throws if the file cannot hold `size` bytes even at deflate's best ratio: ask before allocating them.
  void expect_room_for(std::uint64_t size) const;
  /// The stream's compressed bytes, once expect_end() has returned; 0: it is not compressed.
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
  bool has_members_ = false;               // gzip's: streams may follow one another
  std::vector<unsigned char> compressed_;
  bool is_finished_ = false;  // the stream has met its end
};

/// Bytes of the regular file `file`, part of the image `path`. Throws InputError: missing, not a file, empty.
std::uint64_t file_bytes(const std::string& path, const std::string& file);

}  // namespace podm::verify
