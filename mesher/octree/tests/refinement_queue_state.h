// Test access to the state of a refinement queue.
#pragma once

#include <mutex>

#include "octree/refinement_queue.h"

namespace podm {

class RefinementQueueState {
 public:
  explicit RefinementQueueState(RefinementQueue& queue) : queue_(queue) {}

  struct Counts {
    std::size_t pending, ready;  // leaves with poor cells; leaves of these that may be handed out
    std::size_t active;
    std::size_t waiting;  // nodes to be woken
  };
  Counts counts() const {
    const std::scoped_lock lock(queue_.mutex_);
    std::size_t num_ready = 0;
    for (const auto& ready : queue_.ready_) num_ready += ready.size();
    return {queue_.num_pending_, num_ready, queue_.num_active_, queue_.num_waiting_};
  }

  /// Returns a leaf for the node; nothing if the node would have to wait.
  std::optional<LeafId> pop(unsigned node) {
    const std::scoped_lock lock(queue_.mutex_);
    return queue_.take(node);
  }

 private:
  RefinementQueue& queue_;
};

inline std::optional<LeafId> pop(RefinementQueue& queue, unsigned node) {
  return RefinementQueueState(queue).pop(node);
}

}  // namespace podm
