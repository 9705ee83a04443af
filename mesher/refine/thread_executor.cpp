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

ThreadExecutor::ThreadExecutor(Watch& watch, const CoordinationOptions& options)
    : watch_(watch),
      coordination_(options, [this](WorkerId worker) { desks_[worker].woken.notify_one(); }),
      desks_(static_cast<std::size_t>(options.num_workers)) {}

StopReason ThreadExecutor::run(Workers& workers) {
  {
    std::vector<boost::scoped_thread<>> threads;
    try {
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

void ThreadExecutor::work(Worker<VertexLocks>& worker, WorkerId self) try {
  int conflicts = 0, successes = 0, attempts = 0;  // the first two in a row
  // Relaxed: whoever ends the run leaves through the mutex or a join anyway.
  while (!is_over_.load(std::memory_order_relaxed)) {
    if (!worker.has_work() && !beg(worker, self)) break;
    const Outcome outcome = worker.attempt();
    worker.release();
    if (outcome == Outcome::kLockConflict) {
      successes = 0;
      yield_after_conflict(self, worker.conflicting_worker(), ++conflicts);
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
    if (++attempts % Watch::kAttemptsBetweenChecks == 0) check(worker, self);
  }
  desks_[self].overhead.rollback_s += std::chrono::duration<double>(worker.counters().rollback).count();
} catch (const std::bad_alloc&) {
  end(StopReason::kMemoryLimit);
} catch (...) {
  end(StopReason::kCancelled, std::current_exception());
}

// False: the run is over.
bool ThreadExecutor::beg(Worker<VertexLocks>& worker, WorkerId self) {
  const SecondsInto total(desks_[self].overhead.begging_s);
  std::unique_lock lock(mutex_);
  if (!coordination_.beg(self)) {
    lock.unlock();
    end(StopReason::kComplete);
    return false;
  }
  desks_[self].woken.wait(lock, [&] { return coordination_.is_running(self) || is_over_; });
  worker.give(coordination_.take_gift(self));
  return !is_over_;
}

void ThreadExecutor::yield_after_conflict(WorkerId self, WorkerId holder, int in_a_row) {
  const SecondsInto total(desks_[self].overhead.contention_s);
  std::unique_lock lock(mutex_);
  const auto answer = coordination_.conflict(self, holder, in_a_row);
  if (answer.kind == ContentionManager::Answer::kWait) {
    desks_[self].woken.wait(lock, [&] { return coordination_.is_running(self) || is_over_; });
  } else if (answer.kind == ContentionManager::Answer::kPause) {
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::duration<double>(answer.pause_s));
  }
}

void ThreadExecutor::check(const Worker<VertexLocks>& worker, WorkerId self) {
  desks_[self].net_cells.store(worker.net_cells(), std::memory_order_relaxed);
  std::int64_t cells = 0;
  for (const Desk& desk : desks_) cells += desk.net_cells.load(std::memory_order_relaxed);
  const auto total = static_cast<std::uint64_t>(std::max<std::int64_t>(cells, 0));
  if (const auto reason = watch_.reason_to_stop(total)) end(*reason);
  if (self == 0) watch_.observe(total);
}

// The first reason counts.
void ThreadExecutor::end(StopReason reason, const std::exception_ptr& failure) {
  const std::scoped_lock lock(mutex_);
  if (!failure_) failure_ = failure;
  if (!is_over_) stop_reason_ = reason;
  is_over_ = true;
  for (Desk& desk : desks_) desk.woken.notify_all();
}

}  // namespace podm
