#include "workers/contention_manager.h"

namespace podm {

void ContentionManager::Queue::add(WorkerId worker) {
  waiting.push_back(worker);
  num_waiting.store(static_cast<int>(waiting.size()), std::memory_order_relaxed);
}

WorkerId ContentionManager::Queue::take_first() {
  if (waiting.empty()) return kNoWorker;
  const WorkerId first = waiting.front();
  waiting.pop_front();
  num_waiting.store(static_cast<int>(waiting.size()), std::memory_order_relaxed);
  return first;
}

ContentionManager::ContentionManager(Contention kind, int num_workers, std::uint64_t seed)
    : kind_(kind), queues_(static_cast<std::size_t>(num_workers)), num_running_(num_workers), random_(seed) {}

auto ContentionManager::conflict(WorkerId self, WorkerId holder, int in_a_row) -> Answer {
  switch (kind_) {
    case Contention::kAggressive:
      break;
    case Contention::kRandom:
      if (in_a_row >= kConflictsToPause) return {Answer::kPause, random_pause_s()};
      break;
    case Contention::kGlobal:
      if (wait_for_any(self)) return {Answer::kWait, 0};
      break;
    case Contention::kLocal:
      if (wait_for(self, holder)) return {Answer::kWait, 0};
  }
  return {};
}

double ContentionManager::random_pause_s() {
  const std::scoped_lock lock(random_mutex_);
  return 1e-3 * std::uniform_real_distribution(1.0, double{kConflictsToPause})(random_);
}

bool ContentionManager::wait_for_any(WorkerId self) {
  Queue& queue = queue_of(self);
  const std::scoped_lock lock(queue.mutex);
  if (num_running_ == 1) return false;
  stop_running(queue);
  queue.add(self);
  return true;
}

bool ContentionManager::wait_for(WorkerId self, WorkerId holder) {
  Queue &own = queue_of(self), &queue = queue_of(holder);
  const std::scoped_lock lock(own.mutex, queue.mutex);
  if (!queue.owner_runs) return false;
  stop_running(own);
  queue.add(self);
  return true;
}

WorkerId ContentionManager::wake(WorkerId self) {
  Queue& queue = queue_of(self);
  WorkerId first;
  {
    const std::scoped_lock lock(queue.mutex);
    first = queue.take_first();
  }
  if (first != kNoWorker) run_again(first);
  return first;
}

std::vector<WorkerId> ContentionManager::begin_to_beg(WorkerId self) {
  std::vector<WorkerId> woken;
  {
    Queue& queue = queue_of(self);
    const std::scoped_lock lock(queue.mutex);
    const bool wakes_all = kind_ != Contention::kGlobal || num_running_ == 1;
    while (wakes_all && !queue.waiting.empty()) woken.push_back(queue.take_first());
    stop_running(queue);
  }
  for (const WorkerId worker : woken) run_again(worker);
  return woken;
}

void ContentionManager::stop_running(Queue& own) {
  if (kind_ == Contention::kGlobal) {
    --num_running_;
  } else {
    own.owner_runs = false;
  }
}

// A woken worker counts as waiting until its lock is acquired here. Until then other workers that meet it try
// again instead of waiting.
void ContentionManager::run_again(WorkerId worker) {
  if (kind_ == Contention::kGlobal) {
    ++num_running_;
  } else {
    const std::scoped_lock lock(queues_[worker].mutex);
    queues_[worker].owner_runs = true;
  }
}

}  // namespace podm
