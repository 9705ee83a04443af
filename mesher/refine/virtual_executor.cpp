#include "refine/virtual_executor.h"

#include <new>

namespace podm {

namespace {

// Work that attempts are charged for.
struct Work {
  std::uint64_t attempts = 0, classified = 0, tests = 0, created = 0;
};

Work work_of(const Worker<VertexLocks>& worker) {
  return {1, worker.counters().classified_cells, worker.operation_counters().conflict_tests,
          worker.operation_counters().cells_created};
}

// kMeasured: seconds of each kind of work, from a profile of the liver at 3 M cells on one core of an AMD
// EPYC (Zen 5). A constant error changes the speed, not who meets whom.
constexpr double kListed = 0.03e-6, kClassified = 1.2e-6, kTested = 0.035e-6, kCreated = 0.09e-6;
constexpr double kUnit = 1e-6;

double seconds(VirtualCost cost, const Work& before, const Work& after) {
  if (cost == VirtualCost::kUnit) return kUnit;
  return kListed + kClassified * static_cast<double>(after.classified - before.classified) +
         kTested * static_cast<double>(after.tests - before.tests) +
         kCreated * static_cast<double>(after.created - before.created);
}

}  // namespace

VirtualExecutor::VirtualExecutor(Watch& watch, const CoordinationOptions& options, VirtualCost cost)
    : watch_(watch),
      cost_(cost),
      random_(options.seed),
      coordination_(options, [this](WorkerId worker) { resume(worker); }),
      desks_(static_cast<std::size_t>(options.num_workers)) {}

StopReason VirtualExecutor::run(Workers& workers) try {
  for (WorkerId self = 0; self < workers.size(); ++self) schedule(self, 0);
  while (!events_.empty()) {
    const Event event = events_.top();
    events_.pop();
    now_s_ = event.time_s;
    if (!step(*workers[event.worker], event.worker)) return StopReason::kComplete;
    if (num_events_ % Watch::kAttemptsBetweenChecks == 0) {
      if (const auto reason = reason_to_stop(workers)) {
        for (const auto& worker : workers) worker->release();
        return *reason;
      }
    }
  }
  throw InternalError("virtual time stands still: every worker waits");
} catch (const std::bad_alloc&) {
  return StopReason::kMemoryLimit;
}

// False: the last worker with cells has run out of them.
bool VirtualExecutor::step(Worker<VertexLocks>& worker, WorkerId self) {
  Desk& desk = desks_[self];
  if (desk.in_progress && !end_attempt(worker, self)) return true;
  worker.give(coordination_.take_gift(self));
  if (worker.has_work()) {
    begin_attempt(worker, self);
    return true;
  }
  desk.since_s = now_s_;
  desk.begs = true;
  return coordination_.beg(self);
}

void VirtualExecutor::begin_attempt(Worker<VertexLocks>& worker, WorkerId self) {
  const Work before = work_of(worker);
  desks_[self].since_s = now_s_;
  desks_[self].in_progress = worker.attempt();
  if (desks_[self].in_progress == Outcome::kLockConflict) worker.release();
  // Seeded perturbation: attempts of equal work do not end together.
  const double stretch = std::uniform_real_distribution(0.5, 1.5)(random_);
  schedule(self, stretch * seconds(cost_, before, work_of(worker)));
}

// False: the worker does not go on at once.
bool VirtualExecutor::end_attempt(Worker<VertexLocks>& worker, WorkerId self) {
  Desk& desk = desks_[self];
  const Outcome outcome = *desk.in_progress;
  desk.in_progress.reset();
  worker.release();
  if (outcome == Outcome::kLockConflict) {
    desk.overhead.rollback_s += now_s_ - desk.since_s;
    desk.since_s = now_s_;
    desk.successes = 0;
    const auto answer = coordination_.conflict(self, worker.conflicting_worker(), ++desk.conflicts);
    if (answer.kind == ContentionManager::Answer::kPause) {
      desk.overhead.contention_s += answer.pause_s;
      schedule(self, answer.pause_s);
    }
    return answer.kind == ContentionManager::Answer::kTryOn;
  }
  if (outcome == Outcome::kCommitted) {
    desk.conflicts = 0;
    if (++desk.successes % ContentionManager::kSuccessesToWake == 0) coordination_.wake_one(self);
  }
  if (coordination_.may_share(self, worker.num_listed())) coordination_.share(self, worker);
  return true;
}

void VirtualExecutor::schedule(WorkerId worker, double delay_s) {
  events_.push({now_s_ + delay_s, num_events_++, worker});
}

void VirtualExecutor::resume(WorkerId worker) {
  Desk& desk = desks_[worker];
  (desk.begs ? desk.overhead.begging_s : desk.overhead.contention_s) += now_s_ - desk.since_s;
  desk.begs = false;
  schedule(worker, 0);
}

std::optional<StopReason> VirtualExecutor::reason_to_stop(const Workers& workers) {
  std::int64_t cells = 0;
  for (const auto& worker : workers) cells += worker->net_cells();
  const auto total = static_cast<std::uint64_t>(std::max<std::int64_t>(cells, 0));
  watch_.observe(total);
  return watch_.reason_to_stop(total);
}

}  // namespace podm
