// Accounting of virtual time: all rules that charge a cost of runtime/time_costs.h, one after the other.
//
// The algorithms do not mention costs. They use objects that workers share in an accounted form. The
// accounted form has operations of the same names, and each has an argument `self`, the worker that carries
// it out. The accounted operation calls the operation of the object and charges the worker for it. In real
// time a charge is an empty function, because operations take the time that they take.
//
//   During a charge other virtual workers run. The order of a charge and its operation therefore decides what
//   they see. Operations under a lock that many workers use are charged in a section that admits one worker
//   at a time. The wrapped object identifies the section.
//
// The rules are part of the frozen model. A change of a rule, of the worker that is charged, or of the order
// of a charge and its operation makes another version of the model. The rules of shared lines and new memory
// came later. They charge nothing on machines without their constants, whose results they leave as they were.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

#include "delaunay/pool.h"
#include "podm/counters.h"
#include "refine/outcome.h"
#include "runtime/time_costs.h"
#include "runtime/worker_id.h"
#include "workers/coordination.h"

namespace podm {

// ---- An attempt ----

/// Counted work of a worker, so far or between two points in time.
struct Work {
  std::uint64_t classified = 0, searches = 0, tests = 0, created = 0, planned = 0;

  Work operator-(const Work& b) const {
    return {classified - b.classified, searches - b.searches, tests - b.tests, created - b.created,
            planned - b.planned};
  }
};
inline Work work_of(const Counters& counters) {
  return {counters.classified_cells, counters.oracle_searches, counters.conflict_tests,
          counters.cells_created, counters.planned_cells};
}

/// Returns the seconds of an attempt with this work. An attempt takes locks if other workers may use the same
/// vertices.
inline double attempt_seconds(const Work& work, const TimeCosts& costs, bool takes_locks) {
  const double seconds =
      costs.list_looked_up + costs.classified * static_cast<double>(work.classified) +
      costs.searched * static_cast<double>(work.searches) + costs.tested * static_cast<double>(work.tests) +
      costs.created * static_cast<double>(work.created) + costs.planned * static_cast<double>(work.planned);
  return takes_locks ? (1 + costs.locked) * seconds : seconds;
}
/// Returns the seconds of an attempt before it takes its first lock.
inline double seconds_before_locks(const TimeCosts& costs) { return costs.list_looked_up; }
/// Returns the factor by which an attempt is longer or shorter. Attempts of equal work therefore do not end
/// together.
inline double draw_stretch(const TimeCosts& costs, std::mt19937_64& random) {
  return std::uniform_real_distribution(1 - costs.spread, 1 + costs.spread)(random);
}

// ---- Shared lines and new memory, during an attempt ----
//
// A cache line that all workers write is a section. It charges MachineModel::line_transfer_s to a worker
// unless it was itself the last to enter. Such lines are the mutex of each section, the mutex of the arenas
// of ids, and the number of cells (StopControl). A conflict takes one transfer: of the lock that another
// worker holds. The system provides new memory in another section, where each page takes
// MachineModel::page_fault_s. Commits share no line (delaunay/commit_order.h).

inline constexpr std::uint64_t kPageBytes = 4096;

/// Returns the requests so far by a worker that makes cells; none by other workers.
template <class Worker>
SharedRequests shared_requests_of(const Worker& worker) {
  if constexpr (requires { worker.shared_requests(); })
    return worker.shared_requests();
  else
    return {};
}

/// Uses by an attempt of what all workers share.
struct SharedUse {
  std::uint64_t locks_of_ids = 0, new_pages = 0;
  bool reports_cells = false;
};
inline SharedUse shared_use(const SharedRequests& before, const SharedRequests& now, bool reports_cells) {
  return {now.locks - before.locks, now.new_bytes / kPageBytes - before.new_bytes / kPageBytes,
          reports_cells};
}

// ---- Between attempts ----

inline double seconds_to_give(std::size_t num_entries, const TimeCosts& costs) {
  return costs.entry_given * static_cast<double>(num_entries);
}
inline double seconds_to_list_with_leaves(std::size_t num_entries, const TimeCosts& costs) {
  return costs.entry_to_leaf * static_cast<double>(num_entries);
}

/// A group of workers. Begging, and serving a begging worker, are charged in a section.
template <class Time>
class AccountedGroup {
 public:
  using Entries = Coordination::Entries;

  AccountedGroup(Coordination& group, Time& time) : group_(group), time_(time) {}

  /// Charged afterwards, if the worker has given cells to another one.
  template <class Worker>
  Coordination::Answer after(Outcome outcome, WorkerId self, Worker& worker) const {
    const std::size_t num_listed = worker.num_listed();
    const Coordination::Answer answer = group_.after(outcome, self, worker);
    if (const std::size_t given = num_listed - worker.num_listed(); given > 0)
      time_.spend_in(&group_, self, seconds_to_serve_with(given));
    return answer;
  }
  /// Charged before the cells arrive.
  void send(WorkerId self, unsigned home, const Entries& cells) const {
    time_.spend(self, seconds_to_serve_with(cells.size()));
    group_.send(home, cells);
  }
  /// Charged before the worker is listed.
  Coordination::Begging beg(WorkerId self) const {
    time_.spend_in(&group_, self, time_.costs().begging);
    return group_.beg(self);
  }
  Entries take_gift(WorkerId self) const {
    Entries gift = group_.take_gift(self);
    time_.spend(self, seconds_to_give(gift.size(), time_.costs()));
    return gift;
  }

 private:
  double seconds_to_serve_with(std::size_t num_entries) const {
    return time_.costs().begging + seconds_to_give(num_entries, time_.costs());
  }

  Coordination& group_;
  Time& time_;
};

/// The refinement queue (octree/refinement_queue.h). Its lock is charged as a section, before each operation.
template <class Queue, class Time>
class AccountedQueue {
 public:
  AccountedQueue(Queue& queue, Time& time) : queue_(queue), time_(time) {}

  template <class Wait, class Stop>
  auto wait_and_pop(WorkerId self, unsigned node, const Wait& wait, const Stop& stop) const {
    time_.spend_in(&queue_, self, time_.costs().leaf_handed_out);
    return queue_.wait_and_pop(node, wait, stop);
  }
  template <class Leaf>
  void finish(WorkerId self, Leaf leaf) const {
    time_.spend_in(&queue_, self, time_.costs().leaf_handed_out);
    queue_.finish(leaf);
  }
  /// The queue itself, for the accounted operations of leaf cells.
  Queue& plain() const { return queue_; }

 private:
  Queue& queue_;
  Time& time_;
};

/// The cells of leaves (algorithms/leaf_cells.h).
template <class Cells, class Time>
class AccountedLeafCells {
 public:
  AccountedLeafCells(Cells& cells, Time& time) : cells_(cells), time_(time) {}

  std::size_t num_slices() const { return cells_.num_slices(); }
  void distribute(WorkerId self, std::size_t slice) const {
    time_.spend(self, seconds_to_list_with_leaves(cells_.distribute(slice), time_.costs()));
  }
  template <class Queue, class Stop>
  void share_out(WorkerId self, const AccountedQueue<Queue, Time>& queue, const Stop& stop) const {
    cells_.share_out(queue.plain(), stop);
    time_.spend(self, time_.costs().leaf_shared_out * cells_.num_leaves());
  }
  /// Each worker updates one of `num_workers` parts.
  template <class Moves>
  void rename(WorkerId self, const Moves& moves, std::size_t num_workers) const {
    time_.spend(self, seconds_to_give(cells_.rename(moves, self, num_workers), time_.costs()));
  }
  template <class Leaf>
  auto take(WorkerId self, Leaf leaf) const {
    auto poor = cells_.take(leaf);
    time_.spend(self, seconds_to_give(poor.size(), time_.costs()));
    return poor;
  }
  /// Charged before the cells are listed.
  template <class Entries, class Queue, class Stop>
  void add(WorkerId self, const Entries& entries, const AccountedQueue<Queue, Time>& queue,
           const Stop& stop) const {
    time_.spend(self, seconds_to_list_with_leaves(entries.size(), time_.costs()));
    cells_.add(entries, queue.plain(), stop);
  }
  /// Ends the leaf of a computing node (algorithms/computing_node.h). The master is charged once for all
  /// workers of the node, after the cells of other leaves are listed.
  template <class Node, class Queue, class Stop>
  auto end(Node& node, const AccountedQueue<Queue, Time>& queue, const Stop& stop) const {
    const double handing_over_s = seconds_to_list_with_leaves(node.num_foreign(), time_.costs());
    auto activation = node.end(cells_, queue.plain(), stop);
    time_.spend(node.master().id(), handing_over_s);
    return activation;
  }

 private:
  Cells& cells_;
  Time& time_;
};

/// The move of a mesh to other nodes (delaunay/relocation.h), charged for cells only.
template <class Moves, class Time>
class AccountedRelocation {
 public:
  AccountedRelocation(Moves& moves, Time& time) : moves_(moves), time_(time) {}

  template <class NodeOf>
  void look(WorkerId self, const NodeOf& node_of) const {
    moves_.look(self, node_of);
    time_.spend(self, seconds_to_list_with_leaves(moves_.cell_bound(), time_.costs()) / moves_.num_workers());
  }
  template <class Pool>
  void rename(WorkerId self, Pool& pool) const {
    moves_.rename(self, pool);
  }
  template <class Pool>
  void move(WorkerId self, Pool& pool) const {
    time_.spend(self, time_.costs().cell_moved * static_cast<double>(moves_.move(self, pool)));
  }

 private:
  Moves& moves_;
  Time& time_;
};

/// Calls judge(self), which returns the number of cells whose dihedral angles it has checked, and charges the
/// worker for these cells.
template <class Judge, class Time>
void judge_cells(WorkerId self, const Judge& judge, Time& time) {
  time.spend(self, time.costs().cell_judged * judge(self));
}

// ---- Before and after refinement ----

/// Work of a phase that no virtual worker does: `count` pieces of equal cost. A loop divides it among all
/// threads.
struct PhaseWork {
  double TimeCosts::*cost;
  std::uint64_t count;

  double seconds(const TimeCosts& costs) const { return costs.*cost * static_cast<double>(count); }
};
/// The thread that calls the run starts the threads of the other workers.
inline PhaseWork starting_threads(int num_workers) {
  return {&TimeCosts::thread_started, static_cast<std::uint64_t>(num_workers - 1)};
}
inline PhaseWork making_cubes(std::uint64_t count) { return {&TimeCosts::cube_made, count}; }
inline PhaseWork looking_up_places(std::uint64_t count) { return {&TimeCosts::place_looked_up, count}; }
inline PhaseWork reading_voxels(std::uint64_t count) { return {&TimeCosts::voxel_read, count}; }
inline PhaseWork transforming_voxels(std::uint64_t count) { return {&TimeCosts::voxel_transformed, count}; }
inline PhaseWork extracting_cells(std::uint64_t count) { return {&TimeCosts::cell_extracted, count}; }

}  // namespace podm
