// Arrays that grow without moving. Address space is reserved once; memory is allocated at first touch, in
// huge pages where the kernel grants them. Growth copies nothing, and unused pages take no memory.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

namespace podm {

template <class T>
class HugeArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Reserves room for `capacity` elements. Throws std::bad_alloc if the address space is not available.
  explicit HugeArray(std::size_t capacity) : capacity_(capacity) {
    void* memory = mmap(nullptr, capacity * sizeof(T), PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    madvise(memory, capacity * sizeof(T), MADV_HUGEPAGE);  // optional: a failure is harmless
    data_ = static_cast<T*>(memory);
  }
  ~HugeArray() {
    if (data_ != nullptr) munmap(data_, capacity_ * sizeof(T));
  }
  HugeArray(const HugeArray&) = delete;
  HugeArray& operator=(const HugeArray&) = delete;

  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t capacity() const { return capacity_; }
  /// Returns the whole pages of the elements begin to end to the system. The elements must not be read any
  /// more.
  void release(std::size_t begin, std::size_t end) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const auto address = [&](std::size_t i) { return reinterpret_cast<std::uintptr_t>(data_ + i); };
    const std::uintptr_t first = (address(begin) + page - 1) / page * page, last = address(end) / page * page;
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
  }

 private:
  T* data_ = nullptr;
  std::size_t capacity_ = 0;
};

}  // namespace podm
