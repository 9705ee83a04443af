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
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
