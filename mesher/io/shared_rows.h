// Rows of numbers that several processes write at once, each its own, into arrays of one file.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

#include "files/temporary_file.h"

namespace podm {

static_assert(std::endian::native == std::endian::little, "the files declare little-endian data");

/// An array of rows in a file.
struct RowsInFile {
  std::uint64_t offset = 0;       ///< of its first byte
  std::uint64_t num_columns = 1;  ///< numbers per row
};

/// Writes rows [first_row, first_row + num_rows) of an array of `Value`. `value_at(row, column)` counts rows
/// from 0.
template <class Value, class ValueAt>
void write_rows(SharedFile& file, const RowsInFile& to, std::uint64_t first_row, std::uint64_t num_rows,
                const ValueAt& value_at) {
  constexpr std::uint64_t kBlockRows = 1 << 16;
  std::vector<Value> block;
  for (std::uint64_t begin = 0; begin < num_rows; begin += kBlockRows) {
    const std::uint64_t end = std::min(begin + kBlockRows, num_rows);
    block.clear();
    for (std::uint64_t row = begin; row < end; ++row)
      for (std::uint64_t column = 0; column < to.num_columns; ++column)
        block.push_back(static_cast<Value>(value_at(row, column)));
    file.write(to.offset + (first_row + begin) * to.num_columns * sizeof(Value),
               {reinterpret_cast<const char*>(block.data()), block.size() * sizeof(Value)});
  }
}

}  // namespace podm
