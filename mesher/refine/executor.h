// Executors run workers; they alone know of time, limits and waiting. This one runs a single worker on the
// calling thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "podm/mesh_image.h"
#include "refine/worker.h"

namespace podm {

/// Ends of a run that are not completion. 0: none.
struct Limits {
  std::uint64_t max_cells = 0;  // of the store
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

class SerialExecutor {
 public:
  /// `observe(cells)` is called a few times a second.
  SerialExecutor(const Limits& limits, std::stop_token stop, std::function<void(std::uint64_t)> observe)
      : limits_(limits), stop_(std::move(stop)), observe_(std::move(observe)) {}

  /// Runs until the worker's poor element list is empty or something ends the run, always between operations.
  StopReason run(Worker<NoLocks>& worker, const Mesh& mesh);

 private:
  Limits limits_;
  std::stop_token stop_;
  std::function<void(std::uint64_t)> observe_;
};

}  // namespace podm
