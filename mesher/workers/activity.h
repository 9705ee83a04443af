// Who of the workers runs, waits for another after a conflict, or begs for work.
#pragma once

#include <vector>

#include "delaunay/vertex_locks.h"

namespace podm {

class Activity {
 public:
  enum class State { kRunning, kWaiting, kBegging };

  explicit Activity(int num_workers)
      : states_(static_cast<std::size_t>(num_workers), State::kRunning), num_running_(num_workers) {}

  State of(WorkerId worker) const { return states_[worker]; }
  int num_running() const { return num_running_; }
  void set(WorkerId worker, State state) {
    num_running_ += (state == State::kRunning) - (states_[worker] == State::kRunning);
    states_[worker] = state;
  }

 private:
  std::vector<State> states_;
  int num_running_;
};

}  // namespace podm
