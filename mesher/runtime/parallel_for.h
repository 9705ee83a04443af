// Loops whose iterations any thread may take.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "runtime/first_fault.h"
#include "runtime/virtual_threads.h"

namespace podm {

/// Returns the requested number of threads, or the number of all cores if `asked` is 0.
inline std::size_t num_threads(int asked) {
  return asked > 0 ? static_cast<std::size_t>(asked) : std::max(1u, std::thread::hardware_concurrency());
}

/// Calls work(i, thread) once for each i < count, on `threads` threads numbered from 0, which is the
/// caller's. A free thread takes the next i. Throws the first exception that work() throws, once all threads
/// have ended. The threads of a rank in virtual time are virtual.
template <class Work>
void parallel_for(std::size_t count, std::size_t threads, const Work& work) {
  if (VirtualThreads* const here = VirtualThreads::current()) return here->loop(count, threads, work);
  std::atomic<std::size_t> next{0};
  FirstFault fault;
  const auto run = [&](std::size_t thread) {
    for (std::size_t i = next++; i < count; i = next++) fault.guard([&] { work(i, thread); });
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < std::min(threads, count); ++t) others.emplace_back(run, t);
    run(0);
  }
  fault.rethrow();
}

/// Does the same for consecutive ranges of [0, size): work(begin, end, thread). All have the given length
/// except the last.
template <class Work>
void parallel_for_ranges(std::size_t size, std::size_t length, std::size_t threads, const Work& work) {
  parallel_for((size + length - 1) / length, threads, [&](std::size_t i, std::size_t thread) {
    work(i * length, std::min(size, (i + 1) * length), thread);
  });
}

/// Calls work(i) once for each i < size. A free thread takes the next thousand. Meant for short work.
template <class Work>
void parallel_for_each(std::size_t size, std::size_t threads, const Work& work) {
  constexpr std::size_t kLength = 1 << 10;
  parallel_for_ranges(size, kLength, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

}  // namespace podm
