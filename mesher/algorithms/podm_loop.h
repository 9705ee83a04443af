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
//
// Sources that bring locks of their own include this file and instantiate refine(); all others include
// podm.h.
#pragma once

#include <algorithm>
#include <tuple>
#include <utility>

#include "algorithms/podm.h"
#include "workers/work_cost.h"

namespace podm {

// New cells of other homes go there when they are so many, or when the worker has no others.
inline constexpr std::size_t kAwayToSend = 128;

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
    time.spend(worker.id(),
               time.costs().begging + time.costs().entry_given * static_cast<double>(cells.size()));
    group.send(away[i].home, std::exchange(cells, {}));
  }
}

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
        time.spend_in(&group, self,
                      time.costs().begging + time.costs().entry_given * static_cast<double>(given));
      if (answer == ContentionManager::Answer::kWait) time.block(self, &Overhead::contention_s);
      if (answer == ContentionManager::Answer::kPause) time.pause(self, pause_s);
    } else {
      if (before_begging) before_begging();
      if (worker.num_away() > 0) send_home(worker, group, time);
      time.spend_in(&group, self, time.costs().begging);
      const Coordination::Begging begging = group.beg(self);
      if (begging == Coordination::Begging::kOver) break;
      if (begging == Coordination::Begging::kListed) time.block(self, &Overhead::begging_s);
      const Construction::Entries gift = group.take_gift(self);
      worker.give(gift);
      time.spend(self, time.costs().entry_given * static_cast<double>(gift.size()));
    }
  }
  const bool is_done = !time.is_over();
  time.check_limits(worker);
  return is_done;
}

/// The workers of a group refine these cells. All start at once; those without cells beg until the first has
/// some to share.
template <class Locks, class Time>
void refine(Construction& construction, const Construction::Workers<Locks>& workers,
            const CoordinationOptions& options, const Construction::Entries& cells, Time& time) {
  Coordination group(options, [&](WorkerId worker) { time.resume(worker); });
  workers[0]->give(cells);
  time.run([&](WorkerId self) {
    const bool is_done = refine(*workers[self], group, time);
    if (is_done && self == 0) group.dismiss();
  });
  construction.account(workers, time);
}

}  // namespace podm
