// A file that appears whole or not at all. The bytes go to a temporary file beside the target. It is renamed
// to the target once every byte is on the disk. Until then an older target stays unchanged.
#pragma once

#include <cstddef>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

#include "files/temporary_file.h"

namespace podm {

class AtomicFile {
 public:
  /// Creates the temporary. On failure every member throws InputError with `path` and the system's reason.
  explicit AtomicFile(const std::string& path);

  void write(const void* bytes, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Appends the bytes of `value` as they are in memory.
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= kBufferBytes);
    if (buffered_ + sizeof(T) > kBufferBytes) flush();
    std::memcpy(buffer_.get() + buffered_, &value, sizeof(T));
    buffered_ += sizeof(T);
  }

  /// Writes the bytes to the disk, still under the temporary's name. Nothing may be written afterwards.
  void finish();
  /// Finishes the file and gives it its name.
  void publish();

 private:
  static constexpr std::size_t kBufferBytes = 1 << 18;
  friend void publish_together(std::deque<AtomicFile>& files);

  void flush();

  TemporaryFile file_;
  std::unique_ptr<char[]> buffer_;
  std::size_t buffered_ = 0;
};

/// Publishes files that belong together: no file gets its name before all are on the disk.
void publish_together(std::deque<AtomicFile>& files);

}  // namespace podm
