// Reads bytes of a file, raw or in base64, piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "readers/byte_buffer.h"
#include "readers/mesh_file.h"

namespace podm::verify {

class VtuBytes {
 public:
  /// Reads the bytes [begin, end) of the file. VTK pads base64 at the end of a header or a block and
  /// continues after it. Padding therefore ends a group of four characters, not the data.
  VtuBytes(const MeshFile& file, std::size_t begin, std::size_t end, bool is_base64)
      : file_(file), next_(begin), end_(end), is_base64_(is_base64) {}

  /// Returns the next `size` bytes. Appends them to `bytes` if they are in base64; raw bytes are not copied.
  std::string_view take(std::uint64_t size, ByteBuffer& bytes);
  /// Returns an upper bound of the number of bytes left.
  std::uint64_t most_left() const;
  std::size_t position() const { return next_; }

 private:
  void decode(char* to, std::size_t size);
  void decode_group();
  [[noreturn]] void refuse_end(std::uint64_t size) const;

  const MeshFile& file_;
  std::size_t next_, end_;
  bool is_base64_;
  char group_[3] = {};  // decoded bytes of the last group; those from group_begin_ on are not taken yet
  int group_begin_ = 0, group_end_ = 0;
};

}  // namespace podm::verify
