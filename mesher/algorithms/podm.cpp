// PODM, Parallel Optimistic Delaunay Meshing. (Foteinos, Chrisochoides, JPDC 74 (2014) 2123-2140.)
//
// Every worker has a list of cells that may be poor. It takes one, and by the first rule that the cell breaks
// plans an insertion, with removals where R6 asks for them. It locks each vertex of each cell that it is
// about to replace, and never waits for one: an operation that meets another's vertex is rolled back, with
// nothing written, and its cell goes back on the list. New cells go on the list of their maker.
//
//   Between any two operations the cells are the Delaunay triangulation of the vertices
//   (delaunay/vertex_locks.h). Between any two operations vertices keep the distances I1 to I3
//   (refine/rules.h), so that insertions end. Every cell that may break a rule is on a list, in a gift, on
//   its way home (podm_home.cpp), or in an operation. So when all workers beg, no cell breaks a rule any
//   more. Who waits, waits for one who runs (workers/contention_manager.h): the last to run never waits.
#include "algorithms/podm.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "algorithms/leaf_locks.h"
#include "refine/virtual_box.h"
#include "workers/work_cost.h"

namespace podm {

namespace {

// New cells of other homes go there when they are so many, or when the worker has no others.
constexpr std::size_t kAwayToSend = 128;

template <class Locks, class Time>
void send_home(Worker<Locks>& worker, Coordination& group, Time& time) {
  auto away = worker.take_away();
  std::sort(away.begin(), away.end(), [](const auto& a, const auto& b) {
    return std::tie(a.home, a.entry.cell) < std::tie(b.home, b.entry.cell);
  });
  Construction::Entries cells;
  for (std::size_t i = 0; i < away.size(); ++i) {
    cells.push_back(away[i].entry);
    if (i + 1 < away.size() && away[i + 1].home == away[i].home) continue;
    time.spend(worker.id(), kBegging + kEntryGiven * static_cast<double>(cells.size()));
    group.send(away[i].home, std::exchange(cells, {}));
  }
}

}  // namespace

template <class Locks, class Time>
bool refine(Worker<Locks>& worker, Coordination& group, Time& time,
            const std::function<void()>& before_begging) {
  const WorkerId self = worker.id();
  while (!time.is_over()) {
    if (worker.has_work()) {
      const Outcome outcome = time.attempt(worker);  // take a cell, lock, plan, commit or roll back, unlock
      const std::size_t num_listed = worker.num_listed();
      if (worker.num_away() >= kAwayToSend) send_home(worker, group, time);
      const auto [answer, pause_s] = group.after(outcome, self, worker);
      if (const std::size_t given = num_listed - worker.num_listed(); given > 0)
        time.spend_in(&group, self, kBegging + kEntryGiven * static_cast<double>(given));
      if (answer == ContentionManager::Answer::kWait) time.block(self, &Overhead::contention_s);
      if (answer == ContentionManager::Answer::kPause) time.pause(self, pause_s);
    } else {
      if (before_begging) before_begging();
      if (worker.num_away() > 0) send_home(worker, group, time);
      time.spend_in(&group, self, kBegging);
      const Coordination::Begging begging = group.beg(self);
      if (begging == Coordination::Begging::kOver) break;
      if (begging == Coordination::Begging::kListed) time.block(self, &Overhead::begging_s);
      const Construction::Entries gift = group.take_gift(self);
      worker.give(gift);
      time.spend(self, kEntryGiven * static_cast<double>(gift.size()));
    }
  }
  const bool is_done = !time.is_over();
  time.check_limits(worker);
  return is_done;
}

namespace {

// The groups of the first workers alone.
CoordinationOptions coordination_of_first(const Team& team, int num_workers) {
  CoordinationOptions options = team.coordination;
  options.num_workers = num_workers;
  for (std::vector<int>& level : options.groups)
    level.resize(std::min(level.size(), static_cast<std::size_t>(num_workers)));
  return options;
}

// All workers start at once; those without cells beg until the first has some to share.
template <class Locks, class Time>
void refine_with(Construction& construction, const Parameters& parameters, const Construction::Entries& cells,
                 int num_workers, const Homes* homes, Time& time) {
  auto workers = construction.make_workers<Locks>(parameters, num_workers);
  CoordinationOptions options = coordination_of_first(construction.team(), num_workers);
  if (homes != nullptr) {
    options.workers_per_home = num_workers / static_cast<int>(homes->number());
    for (const auto& worker : workers)
      worker->keep_to(*homes, worker->id() / static_cast<WorkerId>(options.workers_per_home));
  }
  Coordination group(options, [&](WorkerId worker) { time.resume(worker); });
  workers[0]->give(cells);
  time.run([&](WorkerId self) {
    const bool is_done = refine(*workers[self], group, time);
    if (is_done && self == 0) group.dismiss();
  });
  construction.account(workers, time);
}

}  // namespace

void refine_anywhere(Construction& construction, const std::string& phase, const Parameters& parameters,
                     const Construction::Entries& cells, int num_workers, const Homes* homes) {
  if (construction.stop().is_over()) return construction.timed(phase, [] {});  // every run has this phase
  construction.timed(phase, [&] {
    construction.in_time(phase, num_workers, [&](auto& time) {
      if (num_workers > 1 || construction.team().executor == Executor::kVirtual) {
        refine_with<VertexLocks>(construction, parameters, cells, num_workers, homes, time);
      } else {
        refine_with<NoLocks>(construction, parameters, cells, num_workers, homes, time);
      }
    });
  });
  construction.sample_pages(phase);
}

Parameters parameters_for(const Problem& problem, double ratio, const Box& clamp) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  const SizeField sizes = problem.sizes.scaled(ratio);
  const double delta_mm = ratio * problem.delta_mm;
  const double spacing_mm = std::min(delta_mm, std::sqrt(sizes.smallest_squared_radius()) / k);
  return {.delta_mm = delta_mm, .sizes = sizes, .clamp_box = clamp, .spacing_mm = spacing_mm};
}

Refinement podm(const Problem& problem, const Team& team, StopControl& stop) {
  const Box clamp = clamp_box(problem.object, problem.delta_mm);
  Construction construction(problem, clamp, team, stop);
  refine_anywhere(construction, "refine", parameters_for(problem, 1, clamp), construction.all_cells(),
                  construction.num_workers());
  return construction.finish();
}

template bool refine(Worker<NoLocks>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<VertexLocks>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<VertexLocks>&, Coordination&, VirtualTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<NoLocks>>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<NoLocks>>&, Coordination&, VirtualTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<VertexLocks>>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<VertexLocks>>&, Coordination&, VirtualTime&,
                     const std::function<void()>&);

}  // namespace podm
