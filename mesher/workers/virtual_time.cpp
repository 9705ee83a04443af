#include "workers/virtual_time.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <utility>

#include "podm/errors.h"
#include "runtime/processor_seconds.h"

namespace podm {

namespace {

constexpr double kUnit = 1e-6;

}  // namespace

VirtualTime::VirtualTime(StopControl& stop, std::size_t num_workers, VirtualCost cost, std::uint64_t seed,
                         const MachineModel* machine, std::vector<NodeIndex> nodes)
    : stop_(stop), cost_(cost), random_(seed), states_(num_workers) {
  if (machine == nullptr) return;
  costs_ = machine->costs;
  speed_ = machine->speed_of_one_of(num_workers);
  wake_s_ = machine->wake_s;
  lock_s_ = machine->lock_s;
  line_transfer_s_ = machine->line_transfer_s;
  page_fault_s_ = machine->page_fault_s;
  if (machine->topology.num_nodes() > 1) remote_.emplace(*machine, std::move(nodes));
}

VirtualSpending& VirtualSpending::operator+=(const VirtualSpending& b) {
  work_s += b.work_s;
  remote_memory_s += b.remote_memory_s;
  network_s += b.network_s;
  between_s += b.between_s;
  queueing_s += b.queueing_s;
  return *this;
}

void VirtualTime::run(const std::function<void(WorkerId)>& work) try {
  const double start_s = processor_seconds();
  for (WorkerId self = 0; self < states_.size(); ++self) {
    states_[self].fibre = std::make_unique<Fibre>([&work, self] { work(self); });
    schedule(self, 0);
  }
  const auto is_at_work = [](const WorkerState& state) {
    return state.fibre->state() != Fibre::State::kEnded;
  };
  while (!events_.empty() && !is_over()) {
    const Event event = events_.top();
    events_.pop();
    now_s_ = event.time_s;
    advance(event.worker);
    if (num_events_ % StopControl::kAttemptsBetweenChecks != 0) continue;
    stop_.observe();
    stop_.check_limits();
  }
  if (!is_over() && std::any_of(states_.begin(), states_.end(), is_at_work))
    throw InternalError("virtual time cannot advance: every worker waits");
  finish_all();
  processor_s_ += processor_seconds() - start_s;
} catch (const std::bad_alloc&) {
  stop_.end(StopReason::kMemoryLimit);
  finish_all();
} catch (...) {
  stop_.end(StopReason::kCancelled);
  finish_all();
  throw;
}

// A run ends between operations: operations that have begun are finished.
void VirtualTime::finish_all() {
  std::exception_ptr failure;
  for (WorkerState& state : states_) {
    while (state.fibre && state.fibre->state() != Fibre::State::kEnded) {
      state.fibre->allow(Fibre::kUnlimited);
      try {
        state.fibre->resume();
      } catch (const std::bad_alloc&) {  // the attempt has rolled back
      } catch (...) {
        if (!failure) failure = std::current_exception();
      }
    }
  }
  if (failure) std::rethrow_exception(failure);
}

void VirtualTime::advance(WorkerId worker) {
  WorkerState& state = states_[worker];
  if (state.most_steps > 0) allow_part(state);
  if (state.fibre->resume() != Fibre::State::kOutOfSteps) return;
  // Most stops are short. A few are so long that other workers carry out whole operations.
  schedule(worker, 1e-9 * std::exp(std::uniform_real_distribution(0.0, 12.0)(random_)));
}

void VirtualTime::allow_part(WorkerState& state) {
  state.fibre->allow(std::uniform_int_distribution(std::uint64_t{1}, state.most_steps)(random_));
}

void VirtualTime::begin_attempt(WorkerId self) {
  WorkerState& state = states_[self];
  state.since_s = now_s_;
  if (!kIsInParts || is_over()) return;
  state.most_steps =
      1u << std::uniform_int_distribution(3, 9)(random_);  // some attempts stop at many steps, some at few
  allow_part(state);
}

void VirtualTime::end_attempt(WorkerId self, const Work& work, const std::optional<AccessTally>& accesses,
                              Outcome outcome, const SharedUse& use) {
  WorkerState& state = states_[self];
  state.most_steps = 0;
  state.fibre->allow(Fibre::kUnlimited);
  const double whole_s = draw_stretch(costs_, random_) * reference_seconds(work) / speed_;
  const bool has_failed = outcome == Outcome::kLockConflict;
  const double work_s = has_failed ? std::max(0.0, whole_s - unlocked_seconds()) : whole_s;
  RemoteMemory::Delay remote;
  if (remote_ && accesses) remote = remote_->delay(self, *accesses, state.since_s);
  const double sharing_s = sharing_seconds(self, use, outcome);
  schedule(self, kIsInParts ? 0 : work_s + remote.latency_s + remote.network_s + sharing_s);
  if (!is_over()) state.fibre->suspend();
  if (has_failed) {
    // The seconds in sections are part of the spending already.
    const double in_sections_s = kIsInParts ? 0 : sharing_s - line_transfer_s_;
    state.overhead.rollback_s += std::max(0.0, now_s_ - state.since_s - in_sections_s);
  } else {
    spending_.work_s += work_s;
    spending_.remote_memory_s += remote.latency_s;
    spending_.network_s += remote.network_s;
  }
}

// True if a worker in real time would report its cells at the end of this attempt.
bool VirtualTime::reports_cells(WorkerId self, std::int64_t net_cells) {
  WorkerState& state = states_[self];
  if (++state.num_attempts % StopControl::kAttemptsBetweenChecks != 0 ||
      std::abs(net_cells - state.reported_cells) < stop_.reporting_step(states_.size()))
    return false;
  state.reported_cells = net_cells;
  return true;
}

// The worker arrives at the section in `after_s` seconds. Returns the seconds from now until it leaves.
double VirtualTime::enter(Section& section, WorkerId self, double after_s, double inside_s) {
  if (std::exchange(section.last, self) != self) inside_s += line_transfer_s_;
  const double arrival_s = now_s_ + after_s;
  const double wait_s = std::max(0.0, section.free_at_s - arrival_s);
  spending_.queueing_s += wait_s;
  spending_.between_s += inside_s;
  section.free_at_s = arrival_s + wait_s + inside_s;
  return section.free_at_s - now_s_;
}

// The attempt enters one section after the other at its beginning, as it does stations (remote_memory.h). It
// enters the later ones in advance. An attempt that begins afterwards waits for it even where it arrives
// first.
double VirtualTime::sharing_seconds(WorkerId self, const SharedUse& use, Outcome outcome) {
  if (line_transfer_s_ == 0 && page_fault_s_ == 0) return 0;
  double seconds = outcome == Outcome::kLockConflict ? line_transfer_s_ : 0;
  for (std::uint64_t i = 0; i < use.locks_of_ids; ++i) seconds = enter(ids_, self, seconds, 0);
  if (use.new_pages > 0)
    seconds = enter(memory_map_, self, seconds, page_fault_s_ * static_cast<double>(use.new_pages));
  if (use.reports_cells) seconds = enter(num_cells_, self, seconds, 0);
  return seconds;
}

// Spends the part of a failed attempt in which a real attempt holds no locks yet.
void VirtualTime::pass_unlocked(WorkerId self) {
  const double since_s = now_s_;
  pass(self, unlocked_seconds());
  states_[self].overhead.rollback_s += now_s_ - since_s;
}

double VirtualTime::busy_s() const {
  double busy_s = spending_.work_s + spending_.between_s;
  for (const WorkerState& state : states_) busy_s += state.overhead.rollback_s;
  return busy_s;
}

double VirtualTime::unlocked_seconds() const {
  return (cost_ == VirtualCost::kUnit ? kUnit / 10 : seconds_before_locks(costs_)) / speed_;
}

double VirtualTime::reference_seconds(const Work& work) const {
  return cost_ == VirtualCost::kUnit ? kUnit : attempt_seconds(work, costs_, states_.size() > 1);
}

void VirtualTime::pass(WorkerId self, double seconds) {
  schedule(self, seconds);
  if (!is_over()) states_[self].fibre->suspend();
}

void VirtualTime::spend(WorkerId self, double reference_s) {
  spending_.between_s += reference_s / speed_;
  pass(self, reference_s / speed_);
}

void VirtualTime::spend_in(const void* section, WorkerId self, double reference_s) {
  pass(self, enter(sections_[section], self, 0, lock_s_ + reference_s / speed_));
}

void VirtualTime::schedule(WorkerId worker, double delay_s) {
  events_.push({now_s_ + delay_s, num_events_++, worker});
}

void VirtualTime::block(WorkerId self, double Overhead::*cause) {
  const double since_s = now_s_;
  if (!is_over()) states_[self].fibre->suspend();
  states_[self].overhead.*cause += now_s_ - since_s;
}

void VirtualTime::pause(WorkerId self, double seconds) {
  states_[self].overhead.contention_s += seconds;
  pass(self, seconds);
}

}  // namespace podm
