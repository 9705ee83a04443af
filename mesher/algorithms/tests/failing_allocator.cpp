#include "failing_allocator.h"

#include <cstdlib>
#include <new>

namespace podm::test {
std::atomic<std::int64_t> allocations_left = -1;
}  // namespace podm::test

void* operator new(std::size_t size) {
  auto& left = podm::test::allocations_left;
  if (left.load() >= 0 && left.fetch_sub(1) == 0) throw std::bad_alloc();
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
// The standard library's own calls the one above, but a sanitizer's does not.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
