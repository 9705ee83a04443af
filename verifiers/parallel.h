// Loops over ranges on several threads. Results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace podm::verify {

/// Returns the number of threads for Options::threads; 0 means all cores, shared by `num_ranks`.
inline int num_threads(int asked, int num_ranks = 1) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / num_ranks);
}

/// Calls body(begin, end, thread) for disjoint ranges that cover [0, count), one range per thread. Ranges of
/// thread t come before those of t+1, so partial results joined by thread are the serial ones. The first
/// exception thrown by a body is thrown again here.
template <class Body>
void parallel_ranges(std::size_t count, int threads, Body body) {
  const auto num_threads =
      std::clamp<std::size_t>(static_cast<std::size_t>(threads), 1, std::max<std::size_t>(count, 1));
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto run = [&](std::size_t thread) {
    try {
      body(count * thread / num_threads, count * (thread + 1) / num_threads, thread);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::jthread> helpers;
  for (std::size_t thread = 1; thread < num_threads; ++thread) helpers.emplace_back(run, thread);
  run(0);
  helpers.clear();  // joins
  if (failure) std::rethrow_exception(failure);
}

/// Calls body(begin, end, part) for the ranges of parallel_ranges(). Each thread has a part of its own, which
/// begins as a copy of `empty`. Returns the sum of the parts by their add(), in the order of the ranges.
template <class Part, class Body>
Part sum_over_ranges(std::size_t count, int threads, const Part& empty, const Body& body) {
  std::vector<Part> parts(static_cast<std::size_t>(std::max(threads, 1)), empty);
  parallel_ranges(count, threads, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    body(begin, end, parts[thread]);
  });
  for (std::size_t t = 1; t < parts.size(); ++t) parts[0].add(parts[t]);
  return std::move(parts[0]);
}

}  // namespace podm::verify
