// Bytes that stand in a file as they are or in base64, taken piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "readers/byte_buffer.h"
#include "readers/mesh_file.h"

namespace podm::verify {

class VtuBytes {
 public:
  /// Takes from the bytes [begin, end) of the file. VTK pads base64 where a header or a block ends and goes
  /// on behind it: padding ends a group of four characters, not the data.
  VtuBytes(const MeshFile& file, std::size_t begin, std::size_t end, bool is_base64)
      : file_(file), next_(begin), end_(end), is_base64_(is_base64) {}

  /// Appends the next `size` bytes to `bytes`, or, where they stand in the file as they are, only points
  /// there.
  std::string_view take(std::uint64_t size, ByteBuffer& bytes);
  /// An upper bound of the bytes that are left.
  std::uint64_t most_left() const;
  std::size_t position() const { return next_; }

 private:
  void decode(char* to, std::size_t size);
  void decode_group();
  [[noreturn]] void refuse_end(std::uint64_t size) const;

  const MeshFile& file_;
  std::size_t next_, end_;
  bool is_base64_;
  char group_[3] = {};  // decoded bytes of the last group of which group_begin_.. are not taken
  int group_begin_ = 0, group_end_ = 0;
};

}  // namespace podm::verify
