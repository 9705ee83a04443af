#include "failing_threads.h"

#include <dlfcn.h>
#include <pthread.h>

#include <cerrno>

namespace podm::test {
std::atomic<int> threads_left = -1;
}  // namespace podm::test

// Replaces the function of the C library.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                              void* argument) noexcept {
  auto& left = podm::test::threads_left;
  if (left.load() >= 0 && left.fetch_sub(1) == 0) return EAGAIN;
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  return create(thread, attributes, run, argument);
}
