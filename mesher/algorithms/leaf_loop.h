// PDR.PODM: parallel Delaunay refinement leaf by leaf, with a PODM mesh generator on each computing node.
// (Feng, Tsolakis, Chernikov, Chrisochoides, IMR 2015, section 3; numbers in comments are lines of its Fig.
// 3.) With one worker per node it is PDR. (Chernikov, Chrisochoides, ICS 2004; SISC 28 (2006).)
//
// PODM first makes a coarse mesh. Then an octree divides space into leaves. A queue hands the leaves with
// poor cells out to nodes, which refine them at the same time.
//
//   Nodes take no locks against each other: an operation stays in the region of its leaf, and the regions of
//   active leaves have no point in common (octree/octree.h). A cell whose operation would lock a vertex
//   outside the region waits for the end, when all workers refine the remaining cells anywhere, with PODM.
//   The run therefore ends with the same guarantees as PODM, for any leaves (octree/leaf_region.h).
//
// Sources that bring their own locks include this file. All other sources include podm.h.
#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <mutex>

#include "algorithms/computing_node.h"
#include "algorithms/podm.h"
#include "workers/accounting.h"

namespace podm {

// The state that computing nodes share while they refine leaf after leaf.
template <class Locks, class Time>
struct Leaves {
  const Octree& octree;
  AccountedLeafCells<LeafCells, Time> cells;
  AccountedQueue<RefinementQueue, Time> queue;
  Time& time;
  std::stop_token over;
  bool with_schedule;
  // The number of new cells of other leaves, per worker, above which it pays to wake the other workers of the
  // node: handing them over takes ten times as long as waking a thread.
  static constexpr std::size_t kForeignToShare = 1000;
  std::mutex mutex = {};  // guards the schedule
  std::vector<LeafSchedule::Activation> schedule = {};

  // Lines 9 to 28, run by a node's master. The node's other workers only call refine(), and beg between
  // leaves.
  void refine_one_by_one(ComputingNode<Locks>& node) {
    Worker<Locks>& master = node.master();
    const auto wait = [&] { time.block(master.id(), &Overhead::begging_s); };
    const auto pop = [&] { return queue.wait_and_pop(master.id(), node.number(), wait, over); };
    while (const auto leaf = pop()) {  // 9, 10: B1 and B2 included
      node.begin(octree, *leaf, time.now_s());
      master.give(cells.take(master.id(), *leaf));  // 11
      if (!refine_leaf(node, master)) return;       // 12 to 24, on all workers of the node
      if (!hand_over(node)) return;                 // 21
      end_leaf(node);                               // 25 to 27
    }
    if (!time.is_over()) node.group().dismiss();
  }

  bool refine_leaf(ComputingNode<Locks>& node, Worker<Locks>& worker) {
    return refine(worker, node.group(), time, [&] {
      if (node.hands_over()) hand_over_own(worker);
    });
  }

  // Hands many new cells over to the leaves that contain them: each worker hands over the cells that it made,
  // as one worker alone would keep the others of its node waiting. Few cells are left to end_leaf(). Returns
  // false if the run is over.
  bool hand_over(ComputingNode<Locks>& node) {
    if (node.num_foreign() < kForeignToShare * node.num_workers()) return true;
    node.set_hands_over(true);
    node.group().wake_beggars(node.master().id());
    const bool is_done = refine_leaf(node, node.master());
    node.set_hands_over(false);
    return is_done;
  }

  void hand_over_own(Worker<Locks>& worker) { cells.add(worker.id(), worker.take_foreign(), queue, over); }

  // Ends the leaf. It goes back to the queue if other nodes have listed cells of it.
  void end_leaf(ComputingNode<Locks>& node) {
    const LeafId leaf = node.leaf();
    LeafSchedule::Activation activation = cells.end(node, queue, over);
    if (with_schedule) {
      const std::scoped_lock lock(mutex);
      activation.end_s = time.now_s();  // under the lock: activations are listed by their ends
      schedule.push_back(std::move(activation));
    }
    queue.finish(node.master().id(), leaf);
  }
};

inline std::optional<LeafSchedule> described(const Octree& octree,
                                             std::vector<LeafSchedule::Activation> activations) {
  const Point& origin = octree.origin();
  LeafSchedule schedule{.origin_mm = {origin.x, origin.y, origin.z},
                        .side_mm = octree.finest_side_mm(),
                        .leaves = {},
                        .activations = std::move(activations)};
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf)
    schedule.leaves.push_back({.corner = octree.cube(leaf).corner, .side = octree.cube(leaf).side});
  return schedule;
}

// A computing node is one group of workers.
inline CoordinationOptions coordination_of_node(const Team& team) {
  CoordinationOptions options = team.coordination;
  options.num_workers /= team.num_nodes;
  options.groups.clear();
  return options;
}

// Lines 5, 6, run by all workers: the last one to end shares out the listed cells.
template <class Time>
void distribute(const AccountedLeafCells<LeafCells, Time>& cells,
                const AccountedQueue<RefinementQueue, Time>& queue, int num_workers, Time& time,
                const std::stop_token& over) {
  std::atomic<std::size_t> next_slice = 0;
  std::atomic<int> num_at_work = num_workers;
  time.run([&](WorkerId self) {
    for (std::size_t slice = next_slice++; slice < cells.num_slices() && !time.is_over();
         slice = next_slice++)
      cells.distribute(self, slice);
    if (--num_at_work > 0) return;
    cells.share_out(self, queue, over);
  });
}

// Moves each node's share of the initial mesh to the node's memory. Only then do its workers find in that
// memory the cells that they work on, and the vertices, which stay. These vertices are few, but they are the
// first ones of a leaf and took a third or more of its remote accesses.
template <class Time>
void settle(Construction& construction, const Octree& octree, const RefinementQueue& queue,
            std::size_t workers_per_node, const AccountedLeafCells<LeafCells, Time>& cells, Time& time) {
  const auto relocation = construction.relocate(time, [&](const Point& p) {
    const LeafId leaf = octree.leaf_at(p);
    return leaf == kNoLeaf ? kNoWorker : static_cast<WorkerId>(queue.home_of(leaf) * workers_per_node);
  });
  if (!relocation) return;
  const auto num_workers = static_cast<std::size_t>(construction.num_workers());
  time.run([&](WorkerId self) { cells.rename(self, *relocation, num_workers); });
}

/// Refines the cells of the store, or only the living cells `only`, leaf by leaf with all workers of the
/// team. Returns the cells that no leaf could refine.
template <class Locks, class Time>
Construction::Entries refine_leaf_by_leaf(Construction& construction,
                                          const Construction::Workers<Locks>& workers, const Octree& octree,
                                          bool with_schedule, Time& time,
                                          const Construction::Entries* only = nullptr) {
  const int num_workers = construction.num_workers();
  const std::stop_token over = construction.stop().over();
  if (with_schedule)
    for (const auto& worker : workers) worker->locks().record_leaves();
  const auto num_nodes = static_cast<unsigned>(construction.team().num_nodes);
  const std::size_t per_node = workers.size() / num_nodes;
  const auto resume = [&](WorkerId worker) { time.resume(worker); };

  LeafCells cells(construction.mesh(), octree, only);
  RefinementQueue queue(octree, num_nodes, LeafOrder::kHome,
                        [&](unsigned node) { resume(static_cast<WorkerId>(node * per_node)); });
  std::deque<ComputingNode<Locks>> nodes;  // 8
  for (unsigned node = 0; node < num_nodes; ++node)
    nodes.emplace_back(node, std::span(workers).subspan(node * per_node, per_node),
                       coordination_of_node(construction.team()), resume);
  Leaves<Locks, Time> leaves{.octree = octree,
                             .cells = {cells, time},
                             .queue = {queue, time},
                             .time = time,
                             .over = over,
                             .with_schedule = with_schedule};
  distribute(leaves.cells, leaves.queue, num_workers, time, over);  // 5, 6
  if (construction.mesh().num_nodes() > 1) settle(construction, octree, queue, per_node, leaves.cells, time);
  time.run([&](WorkerId self) {  // 7
    ComputingNode<Locks>& node = nodes[self / per_node];
    if (self % per_node == 0) {
      leaves.refine_one_by_one(node);
    } else {
      leaves.refine_leaf(node, *workers[self]);
    }
  });
  for (auto& node : nodes)
    if (node.has_leaf()) leaves.end_leaf(node);  // the run ended early
  construction.account(workers, time);
  construction.report_leaves(octree.num_leaves(),
                             with_schedule ? described(octree, std::move(leaves.schedule)) : std::nullopt);
  return cells.take_leftover();
}

}  // namespace podm
