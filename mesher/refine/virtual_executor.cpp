#include "refine/virtual_executor.h"

#include <new>

namespace podm {

namespace {

// Work that attempts are charged for.
struct Work {
  std::uint64_t attempts = 0, classified = 0, tests = 0, created = 0;
};

template <class Locks>
Work work_of(const Worker<Locks>& worker) {
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

template <class Locks>
VirtualExecutor<Locks>::VirtualExecutor(Watch& watch, const CoordinationOptions& options, VirtualCost cost,
                                        int num_groups)
    : watch_(watch),
      cost_(cost),
      group_size_(static_cast<WorkerId>(options.num_workers)),
      random_(options.seed),
      desks_(static_cast<std::size_t>(num_groups) * group_size_) {
  for (WorkerId first = 0; first < desks_.size(); first += group_size_) {
    const auto resume_in_group = [this, first](WorkerId worker) { resume(first + worker); };
    groups_.push_back(std::make_unique<Coordination>(options, resume_in_group));
  }
}

template <class Locks>
StopReason VirtualExecutor<Locks>::run(Workers workers, const std::vector<CellSource*>& sources) try {
  sources_ = sources;
  for (WorkerId self = 0; self < workers.size(); ++self) schedule(self, 0);
  while (!events_.empty()) {
    const Event event = events_.top();
    events_.pop();
    now_s_ = event.time_s;
    if (!step(*workers[event.worker], event.worker)) return StopReason::kComplete;
    if (num_events_ % Watch::kAttemptsBetweenChecks == 0) {
      if (const auto reason = reason_to_stop(workers)) {
        stop(workers);
        return *reason;
      }
    }
  }
  throw InternalError("virtual time stands still: every worker waits");
} catch (const std::bad_alloc&) {
  stop(workers);
  watch_.end(StopReason::kMemoryLimit);
  return StopReason::kMemoryLimit;
}

// A run ends between operations: those that have begun end as well.
template <class Locks>
void VirtualExecutor<Locks>::stop(Workers workers) {
  for (WorkerId self = 0; self < workers.size(); ++self) {
    try {
      if (!desks_[self].call.has_ended()) desks_[self].call.finish();
    } catch (const std::bad_alloc&) {  // it has rolled back
    }
    workers[self]->release();
  }
}

// False: the last worker with cells has run out of them, and there are no more.
template <class Locks>
bool VirtualExecutor<Locks>::step(Worker<Locks>& worker, WorkerId self) {
  Desk& desk = desks_[self];
  if (!desk.call.has_ended()) {
    go_on(self);
    return true;
  }
  if (desk.in_progress && !end_attempt(worker, self)) return true;
  worker.give(coordination_of(self).take_gift(within_group(self)));
  if (worker.has_work()) {
    begin_attempt(worker, self);
    return true;
  }
  desk.since_s = now_s_;
  desk.begs = true;
  return coordination_of(self).beg(within_group(self)) || refill_idle_groups();
}

// A group that begs ends its leaf first, which may let others go on. False: all groups are idle for good.
template <class Locks>
bool VirtualExecutor<Locks>::refill_idle_groups() {
  bool is_any_running = false;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t group = 0; group < groups_.size(); ++group) {
      if (groups_[group]->num_running() == 0 && !sources_.empty()) {
        if (auto cells = sources_[group]->next(false)) groups_[group]->give(0, std::move(*cells));
      }
      is_any_running = is_any_running || groups_[group]->num_running() > 0;
    }
  }
  return is_any_running;
}

template <class Locks>
void VirtualExecutor<Locks>::begin_attempt(Worker<Locks>& worker, WorkerId self) {
  Desk& desk = desks_[self];
  desk.since_s = now_s_;
  desk.call.begin([this, &desk, &worker] {
    const Work before = work_of(worker);
    desk.in_progress = worker.attempt();
    if (AttemptCall::kIsInParts || desk.in_progress == Outcome::kLockConflict) worker.release();
    desk.cost_s = AttemptCall::kIsInParts ? 0 : seconds(cost_, before, work_of(worker));
  });
  go_on(self);
}

template <class Locks>
void VirtualExecutor<Locks>::go_on(WorkerId self) {
  if (const auto stop_s = desks_[self].call.go_on(random_)) {
    schedule(self, *stop_s);
    return;
  }
  // Seeded perturbation: attempts of equal work do not end together.
  const double stretch = std::uniform_real_distribution(0.5, 1.5)(random_);
  schedule(self, stretch * desks_[self].cost_s);
}

// False: the worker does not go on at once.
template <class Locks>
bool VirtualExecutor<Locks>::end_attempt(Worker<Locks>& worker, WorkerId self) {
  Desk& desk = desks_[self];
  Coordination& coordination = coordination_of(self);
  const Outcome outcome = *desk.in_progress;
  desk.in_progress.reset();
  worker.release();
  if (outcome == Outcome::kLockConflict) {
    desk.overhead.rollback_s += now_s_ - desk.since_s;
    desk.since_s = now_s_;
    desk.successes = 0;
    const WorkerId holder = worker.conflicting_worker() - group_of(self) * group_size_;
    const auto answer = coordination.conflict(within_group(self), holder, ++desk.conflicts);
    if (answer.kind == ContentionManager::Answer::kPause) {
      desk.overhead.contention_s += answer.pause_s;
      schedule(self, answer.pause_s);
    }
    return answer.kind == ContentionManager::Answer::kTryOn;
  }
  if (outcome == Outcome::kCommitted) {
    desk.conflicts = 0;
    if (++desk.successes % ContentionManager::kSuccessesToWake == 0)
      coordination.wake_one(within_group(self));
  }
  if (coordination.may_share(within_group(self), worker.num_listed()))
    coordination.share(within_group(self), worker);
  return true;
}

template <class Locks>
void VirtualExecutor<Locks>::schedule(WorkerId worker, double delay_s) {
  events_.push({now_s_ + delay_s, num_events_++, worker});
}

template <class Locks>
void VirtualExecutor<Locks>::resume(WorkerId worker) {
  Desk& desk = desks_[worker];
  (desk.begs ? desk.overhead.begging_s : desk.overhead.contention_s) += now_s_ - desk.since_s;
  desk.begs = false;
  schedule(worker, 0);
}

template <class Locks>
std::optional<StopReason> VirtualExecutor<Locks>::reason_to_stop(Workers workers) {
  for (WorkerId self = 0; self < workers.size(); ++self) desks_[self].meter.report(*workers[self], watch_);
  watch_.observe();
  return watch_.reason_to_stop();
}

template class VirtualExecutor<VertexLocks>;
template class VirtualExecutor<LeafLocks<NoLocks>>;
template class VirtualExecutor<LeafLocks<VertexLocks>>;

}  // namespace podm
