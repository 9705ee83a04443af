// Pieces of lists that grow and shrink a lot. Each piece has its own mapping, so its memory returns to the
// system with it. The heap, in contrast, may keep freed memory that lies below memory in use. The pieces are
// too small for the huge pages of huge_array.h.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace podm {

/// An array of kSize elements, zero at first; memory is allocated at first touch, in pages.
template <class T, std::size_t kSize>
class MappedChunk {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Throws std::bad_alloc.
  MappedChunk() {
    void* memory =
        mmap(nullptr, kSize * sizeof(T), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<T*>(memory);
  }
  ~MappedChunk() {
    if (data_ != nullptr) munmap(data_, kSize * sizeof(T));
  }
  MappedChunk(MappedChunk&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}
  MappedChunk& operator=(MappedChunk&& other) noexcept { return std::swap(data_, other.data_), *this; }

  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  T* data_;
};

}  // namespace podm
