// Text for a file, formatted in memory and written in large blocks.
#pragma once

#include <fmt/compile.h>
#include <fmt/format.h>

#include <string_view>

#include "files/atomic_file.h"

namespace podm {

class TextFile {
 public:
  explicit TextFile(AtomicFile& file) : file_(file) {}

  template <class Format, class... Args>
  void print(const Format& format, const Args&... args) {
    fmt::format_to(std::back_inserter(block_), format, args...);
    if (block_.size() >= kBlockBytes) flush();
  }
  void put(std::string_view text) {
    block_.append(text.data(), text.data() + text.size());
    if (block_.size() >= kBlockBytes) flush();
  }
  /// Writes the rest of the text. Must be called at the end.
  void flush() {
    file_.write(block_.data(), block_.size());
    block_.clear();
  }

 private:
  static constexpr std::size_t kBlockBytes = 1 << 16;
  AtomicFile& file_;
  fmt::memory_buffer block_;
};

}  // namespace podm
