// What executors have in common: they run workers until no poor cell is left or something ends the run early.
// They alone know of time, limits, threads and waiting. This file's runs a single worker on the calling
// thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

#include "podm/mesh_image.h"
#include "refine/worker.h"

namespace podm {

/// Ends of a run that are not completion, but for memory, whose lack shows itself. 0: none.
struct Limits {
  std::uint64_t max_cells = 0;  // of the store
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

/// Looks at a run from outside, between operations.
class Watch {
 public:
  static constexpr int kAttemptsBetweenChecks = 1 << 8;  // of each worker, well below a millisecond

  /// `observe(cells)` is called a few times a second.
  Watch(const Limits& limits, std::stop_token stop, std::function<void(std::uint64_t)> observe)
      : limits_(limits), stop_(std::move(stop)), observe_(std::move(observe)) {}

  /// Why the run has to end, with `cells` in the store; nothing if it has not. Any thread may call.
  std::optional<StopReason> reason_to_stop(std::uint64_t cells) const;
  /// One thread calls.
  void observe(std::uint64_t cells);

 private:
  Limits limits_;
  std::stop_token stop_;
  std::function<void(std::uint64_t)> observe_;
  std::chrono::steady_clock::time_point next_observation_ = std::chrono::steady_clock::now();
};

/// Seconds that one worker did not bring the mesh on, by cause.
struct Overhead {
  double contention_s = 0, begging_s = 0, rollback_s = 0;
};

class SerialExecutor {
 public:
  explicit SerialExecutor(Watch& watch) : watch_(watch) {}

  /// Runs until the worker's poor element list is empty or something ends the run, always between operations.
  StopReason run(Worker<NoLocks>& worker);

 private:
  Watch& watch_;
};

}  // namespace podm
