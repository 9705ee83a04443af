// What a refinement queue has at a moment, and whose it is.
#pragma once

#include <mutex>

#include "octree/refinement_queue.h"

namespace podm {

class RefinementQueueState {
 public:
  explicit RefinementQueueState(RefinementQueue& queue) : queue_(queue) {}

  struct Counts {
    std::size_t pending, ready;  // leaves with poor cells; those of them that may be handed out
    std::size_t active;
    std::size_t waiting;  // nodes that are to be woken
  };
  Counts counts() const {
    const std::scoped_lock lock(queue_.mutex_);
    std::size_t num_ready = 0;
    for (const auto& ready : queue_.ready_) num_ready += ready.size();
    return {queue_.num_pending_, num_ready, queue_.num_active_, queue_.num_waiting_};
  }

  /// A leaf for the node; nothing if it would have to wait for one.
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
