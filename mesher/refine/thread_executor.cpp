#include "refine/thread_executor.h"

#include <thread>

namespace podm {

namespace {

// A worker shares when it lists this many cells or more; most are dead, as their turn tells.
constexpr std::size_t kEnoughToShare = 64;
constexpr std::size_t kMostToShare = 1024;

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

ThreadExecutor::ThreadExecutor(Watch& watch, int num_threads, Contention contention, std::uint64_t seed)
    : watch_(watch),
      activity_(num_threads),
      contention_(contention, num_threads, seed),
      begging_(std::vector<int>(static_cast<std::size_t>(num_threads), 0)),
      desks_(static_cast<std::size_t>(num_threads)) {}

StopReason ThreadExecutor::run(Workers& workers, const Mesh& mesh) {
  {
    std::vector<std::jthread> threads;
    for (WorkerId self = 1; self < workers.size(); ++self)
      threads.emplace_back([&, self] { work(*workers[self], self, mesh); });
    work(*workers[0], 0, mesh);
  }
  if (failure_) std::rethrow_exception(failure_);
  return stop_reason_;
}

void ThreadExecutor::work(Worker<VertexLocks>& worker, WorkerId self, const Mesh& mesh) try {
  int conflicts = 0, successes = 0, attempts = 0;  // the first two in a row
  // Relaxed: whoever ends the run leaves through the mutex or a join anyway.
  while (!is_over_.load(std::memory_order_relaxed)) {
    if (!worker.has_work() && !beg(worker, self)) return;
    const Outcome outcome = worker.attempt();
    if (outcome == Outcome::kLockConflict) {
      successes = 0;
      yield_after_conflict(self, worker.conflicting_worker(), ++conflicts);
    } else if (outcome == Outcome::kCommitted) {
      conflicts = 0;
      if (++successes % ContentionManager::kSuccessesToWake == 0 && contention_.has_waiting()) wake_one(self);
    }
    if (!begging_.is_empty() && worker.num_listed() >= kEnoughToShare) share(worker, self);
    if (++attempts % Watch::kAttemptsBetweenChecks == 0) check(worker, self, mesh);
  }
} catch (...) {
  end(StopReason::kCancelled, std::current_exception());
}

// False: the run is over.
bool ThreadExecutor::beg(Worker<VertexLocks>& worker, WorkerId self) {
  const SecondsInto total(desks_[self].idleness.begging_s);
  std::unique_lock lock(mutex_);
  for (const WorkerId waiting : contention_.idle(self, activity_)) set_running(waiting);
  activity_.set(self, Activity::State::kBegging);
  begging_.add(self);
  if (activity_.num_running() == 0) {  // nobody waits either: the last to stop running has woken them
    lock.unlock();
    end(StopReason::kComplete, nullptr);
    return false;
  }
  desks_[self].woken.wait(lock, [&] { return activity_.of(self) == Activity::State::kRunning || is_over_; });
  worker.give(desks_[self].mail);
  desks_[self].mail.clear();
  return !is_over_;
}

void ThreadExecutor::share(Worker<VertexLocks>& worker, WorkerId self) {
  const std::scoped_lock lock(mutex_);
  if (begging_.is_empty()) return;
  std::vector<PoorElementList::Entry> cells = worker.share(kMostToShare);
  if (cells.empty()) return;
  const WorkerId beggar = begging_.take_first(self);
  desks_[beggar].mail = std::move(cells);
  set_running(beggar);
}

void ThreadExecutor::yield_after_conflict(WorkerId self, WorkerId holder, int in_a_row) {
  const SecondsInto total(desks_[self].idleness.contention_s);
  std::unique_lock lock(mutex_);
  const auto answer = contention_.conflict(self, holder, in_a_row, activity_);
  if (answer.kind == ContentionManager::Answer::kWait) {
    activity_.set(self, Activity::State::kWaiting);
    desks_[self].woken.wait(lock,
                            [&] { return activity_.of(self) == Activity::State::kRunning || is_over_; });
  } else if (answer.kind == ContentionManager::Answer::kPause) {
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::duration<double>(answer.pause_s));
  }
}

void ThreadExecutor::wake_one(WorkerId self) {
  const std::scoped_lock lock(mutex_);
  const WorkerId waiting = contention_.wake(self);
  if (waiting != kNoWorker) set_running(waiting);
}

void ThreadExecutor::check(Worker<VertexLocks>& worker, WorkerId self, const Mesh& mesh) {
  desks_[self].net_cells.store(worker.net_cells(), std::memory_order_relaxed);
  std::int64_t cells = 0;
  for (const Desk& desk : desks_) cells += desk.net_cells.load(std::memory_order_relaxed);
  const auto total = static_cast<std::uint64_t>(std::max<std::int64_t>(cells, 0));
  if (const auto reason = watch_.reason_to_stop(total, mesh, desks_.size())) end(*reason, nullptr);
  if (self == 0) watch_.observe(total);
}

void ThreadExecutor::set_running(WorkerId worker) {
  activity_.set(worker, Activity::State::kRunning);
  desks_[worker].woken.notify_one();
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
