// PODM, Parallel Optimistic Delaunay Meshing. (Foteinos, Chrisochoides, JPDC 74 (2014) 2123-2140.)
//
// Every worker has a list of cells that may be poor. It takes a cell and plans an insertion by the first rule
// that the cell violates, with removals where R6 requires them. It locks each vertex of each cell that it is
// about to replace, and never waits for a lock: an operation that meets a vertex of another operation is
// rolled back, with nothing written, and its cell goes back on the list. New cells go on the list of the
// worker that made them.
//
//   Between any two operations the cells are the Delaunay triangulation of the vertices
//   (delaunay/vertex_locks.h). Between any two operations vertices keep the distances of I1 to I3
//   (refine/rules.h), so insertions end. Every cell that may violate a rule is on a list, in a gift, on its
//   way home (podm_home.cpp), or in an operation. Therefore no cell violates a rule when all workers beg.
//   Each worker that waits, waits for one that runs (workers/contention_manager.h): the last running worker
//   never waits.
//
// Sources that bring their own locks include this file and instantiate refine(). All other sources include
// podm.h.
#pragma once

#include <algorithm>
#include <tuple>
#include <utility>

#include "algorithms/podm.h"
#include "workers/accounting.h"

namespace podm {

// New cells of other homes are sent there when there are this many, or when the worker has no other cells.
inline constexpr std::size_t kAwayToSend = 128;

template <class Locks, class Time>
void send_home(Worker<Locks>& worker, const AccountedGroup<Time>& group) {
  auto away = worker.take_away();
  std::sort(away.begin(), away.end(), [](const auto& a, const auto& b) {
    return std::tie(a.home, a.entry.cell) < std::tie(b.home, b.entry.cell);
  });
  Construction::Entries cells;
  for (std::size_t i = 0; i < away.size(); ++i) {
    cells.push_back(away[i].entry);
    if (i + 1 < away.size() && away[i + 1].home == away[i].home) continue;
    group.send(worker.id(), away[i].home, std::exchange(cells, {}));
  }
}

template <class Locks, class Time>
bool refine(Worker<Locks>& worker, Coordination& coordination, Time& time,
            const std::function<void()>& before_begging) {
  const AccountedGroup group(coordination, time);
  const WorkerId self = worker.id();
  while (!time.is_over()) {
    if (worker.has_work()) {
      const Outcome outcome = time.attempt(worker);  // take a cell, lock, plan, commit or roll back, unlock
      if (worker.num_away() >= kAwayToSend) send_home(worker, group);
      const auto [answer, pause_s] = group.after(outcome, self, worker);
      if (answer == ContentionManager::Answer::kWait) time.block(self, &Overhead::contention_s);
      if (answer == ContentionManager::Answer::kPause) time.pause(self, pause_s);
    } else {
      if (before_begging) before_begging();
      if (worker.num_away() > 0) send_home(worker, group);
      const Coordination::Begging begging = group.beg(self);
      if (begging == Coordination::Begging::kOver) break;
      if (begging == Coordination::Begging::kListed) time.block(self, &Overhead::begging_s);
      worker.give(group.take_gift(self));
    }
  }
  const bool is_done = !time.is_over();
  time.check_limits(worker);
  return is_done;
}

/// Refines these cells, which the first worker gets, and those that workers have already. All workers start
/// at once. Workers without cells beg until another one has cells to share.
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
