// A byte buffer that grows without copying or clearing its bytes: large blocks move by page tables alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <string_view>

namespace podm::verify {

class ByteBuffer {
 public:
  /// Returns room for `count` more bytes at the end, not set, valid until the next call. Throws
  /// std::bad_alloc.
  char* extend(std::size_t count) {
    if (count > capacity_ - size_) grow(count);
    size_ += count;
    return bytes_.get() + size_ - count;
  }
  void shrink(std::size_t size) { size_ = size; }

  std::size_t size() const { return size_; }
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  struct Free {
    void operator()(char* bytes) const { std::free(bytes); }
  };

  void grow(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 4 - size_) throw std::bad_alloc();
    const std::size_t capacity = std::max(size_ + count, size_ + size_ / 2);
    auto* bytes = static_cast<char*>(std::realloc(bytes_.get(), capacity));
    if (bytes == nullptr) throw std::bad_alloc();
    static_cast<void>(bytes_.release());
    bytes_.reset(bytes);
    capacity_ = capacity;
  }

  std::unique_ptr<char, Free> bytes_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace podm::verify
