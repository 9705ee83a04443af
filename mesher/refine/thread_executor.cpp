#include "refine/thread_executor.h"

#include <boost/thread/scoped_thread.hpp>
#include <new>
#include <thread>

namespace podm {

namespace {

// Adds the time of its life to a total of seconds.
class SecondsInto {
 public:
  explicit SecondsInto(double& total) : total_(total) {}
  ~SecondsInto() {
    total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  SecondsInto(const SecondsInto&) = delete;
  SecondsInto& operator=(const SecondsInto&) = delete;

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

template <class Locks>
ThreadExecutor<Locks>::ThreadExecutor(Watch& watch, const CoordinationOptions& options,
                                      std::vector<Place> places, WorkerId first_id)
    : watch_(watch),
      places_(std::move(places)),
      first_id_(first_id),
      coordination_(options, [this](WorkerId worker) { desks_[worker].woken.notify_one(); }),
      desks_(static_cast<std::size_t>(options.num_workers)) {}

template <class Locks>
StopReason ThreadExecutor<Locks>::run(Workers workers, CellSource* source) {
  source_ = source;
  {
    std::vector<boost::scoped_thread<>> threads;
    try {
      const SecondsInto total(start_s_);
      threads.reserve(workers.size());
      for (WorkerId self = 1; self < workers.size(); ++self)
        threads.emplace_back([&, self] { work(*workers[self], self); });
    } catch (...) {
      end(StopReason::kCancelled, std::current_exception());
    }
    work(*workers[0], 0);
  }
  if (failure_) std::rethrow_exception(failure_);
  return stop_reason_;
}

template <class Locks>
void ThreadExecutor<Locks>::work(Worker<Locks>& worker, WorkerId self) try {
  const ScopedBinding binding(places_.empty() ? std::nullopt : places_[self].processor);
  desks_[self].processor = processor_of_this_thread();
  int conflicts = 0, successes = 0, attempts = 0;  // the first two in a row
  // Relaxed: whoever ends the run leaves through the mutex or a join anyway.
  while (!is_over_.load(std::memory_order_relaxed)) {
    if (!worker.has_work()) {  // a gift may be empty: a leaf's cells can have been taken with its last ones
      beg(worker, self);
      continue;
    }
    const Outcome outcome = worker.attempt();
    worker.release();
    bool has_slept = false;  // which takes the time of thousands of attempts
    if (outcome == Outcome::kLockConflict) {
      successes = 0;
      has_slept = yield_after_conflict(self, worker.conflicting_worker(), ++conflicts);
    } else if (outcome == Outcome::kCommitted) {
      conflicts = 0;
      if (++successes % ContentionManager::kSuccessesToWake == 0 && coordination_.has_waiting()) {
        const std::scoped_lock lock(mutex_);
        coordination_.wake_one(self);
      }
      if (coordination_.may_share(self, worker.num_listed())) {
        const std::scoped_lock lock(mutex_);
        coordination_.share(self, worker);
      }
    }
    if (++attempts % Watch::kAttemptsBetweenChecks == 0 || has_slept) check(worker, self);
  }
  desks_[self].overhead.rollback_s += std::chrono::duration<double>(worker.counters().rollback).count();
} catch (const std::bad_alloc&) {
  end(StopReason::kMemoryLimit);
} catch (...) {
  end(StopReason::kCancelled, std::current_exception());
}

template <class Locks>
void ThreadExecutor<Locks>::beg(Worker<Locks>& worker, WorkerId self) {
  const SecondsInto total(desks_[self].overhead.begging_s);
  std::unique_lock lock(mutex_);
  if (!coordination_.beg(self) && !refill(self)) {
    lock.unlock();
    return end(StopReason::kComplete);
  }
  desks_[self].woken.wait(lock, [&] { return coordination_.is_running(self) || is_over_; });
  worker.give(coordination_.take_gift(self));
}

// Asks for more cells when the whole group begs. The others wait without the mutex.
template <class Locks>
bool ThreadExecutor<Locks>::refill(WorkerId self) {
  if (source_ == nullptr || is_over_) return false;
  auto cells = source_->next(true);
  if (!cells) return false;
  coordination_.give(self, std::move(*cells));
  return true;
}

// Whether the worker has waited or paused.
template <class Locks>
bool ThreadExecutor<Locks>::yield_after_conflict(WorkerId self, WorkerId holder, int in_a_row) {
  const SecondsInto total(desks_[self].overhead.contention_s);
  std::unique_lock lock(mutex_);
  const auto answer = coordination_.conflict(self, holder - first_id_, in_a_row);
  if (answer.kind == ContentionManager::Answer::kWait) {
    desks_[self].woken.wait(lock, [&] { return coordination_.is_running(self) || is_over_; });
  } else if (answer.kind == ContentionManager::Answer::kPause) {
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::duration<double>(answer.pause_s));
  }
  return answer.kind != ContentionManager::Answer::kTryOn;
}

template <class Locks>
void ThreadExecutor<Locks>::check(const Worker<Locks>& worker, WorkerId self) {
  desks_[self].meter.report(worker, watch_);
  if (const auto reason = watch_.reason_to_stop()) end(*reason);
  if (first_id_ + self == 0) watch_.observe();
}

// The first reason counts.
template <class Locks>
void ThreadExecutor<Locks>::end(StopReason reason, const std::exception_ptr& failure) {
  const std::scoped_lock lock(mutex_);
  if (!failure_) failure_ = failure;
  if (!is_over_) stop_reason_ = reason;
  is_over_ = true;
  if (reason != StopReason::kComplete) watch_.end(reason);  // for the other groups
  for (Desk& desk : desks_) desk.woken.notify_all();
}

template class ThreadExecutor<VertexLocks>;
template class ThreadExecutor<LeafLocks<NoLocks>>;
template class ThreadExecutor<LeafLocks<VertexLocks>>;

}  // namespace podm
