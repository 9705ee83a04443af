// A worker: one refinement agent with its own poor element list, pool and counters. It performs one operation
// at a time and never blocks, spins or sleeps. The loop in algorithms/podm_loop.h decides when it runs.
#pragma once

#include <cstdint>

#include "delaunay/commit_order.h"
#include "delaunay/operation.h"
#include "refine/homes.h"
#include "refine/line_keeper.h"
#include "refine/outcome.h"
#include "refine/perturbation.h"
#include "refine/poor_element_list.h"
#include "refine/rules.h"

namespace podm {

template <class Locks>
class Worker {
 public:
  /// The log of `order`, if given, receives every commit. Accesses to the mesh are counted if the workers
  /// share a mesh that lies on several nodes, and reads of the image are counted, too, if its `owners` are
  /// given and known.
  Worker(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters, WorkerId self, Pool& pool,
         CommitOrder* order = nullptr, const ImageOwners* owners = nullptr);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  WorkerId id() const { return self_; }
  void give(CellId c) { poor_.push(c, mesh_.stamp(c)); }
  void give(const std::vector<PoorElementList::Entry>& entries) {
    for (const auto& entry : entries) poor_.push(entry.cell, entry.stamp);
  }
  bool has_work() const { return !poor_.is_empty(); }
  std::size_t num_listed() const { return poor_.size(); }
  /// Removes the oldest cells from the list for another worker: about half of them, at most `max` live ones.
  std::vector<PoorElementList::Entry> share(std::size_t max) { return poor_.take_oldest(max, mesh_); }

  /// From now on new cells with another home are kept apart, for the workers of that home. The homes must
  /// outlive this object.
  void keep_to(const Homes& homes, unsigned home) {
    homes_ = &homes;
    home_ = home;
  }
  /// Inserts a vertex on a line, as R0 does, while no other worker runs. `near` is a living cell near it.
  /// Returns kNoVertex if another vertex is too near.
  VertexId insert_on_line(const SurfacePoint& p, CellId near);
  /// Inserts a sample of the isosurface in the ball of the cell `start`, with R6, while no other worker runs.
  /// Returns false if an isosurface vertex is within `least_mm`, or if an edge of a line would be split.
  bool insert_sample(const SurfacePoint& z, CellId start, double least_mm);
  /// The cells that the last insertion made.
  const std::vector<CellId>& created() const { return operation_.created(); }
  /// From now on only R7 is applied, to a mesh that violates no other rule. `seed` seeds the choice of new
  /// places for vertices.
  void begin_perturbation(const DihedralBounds& bounds, std::uint64_t seed);
  Perturbation<Locks>& perturbation() { return *perturbation_; }
  /// A poor cell that R7 could not change.
  struct Kept {
    PoorElementList::Entry entry;
    Unmoved why;
  };
  /// Some entries may be stale.
  std::vector<Kept> take_kept() { return std::exchange(kept_, {}); }

  struct Away {
    unsigned home;
    PoorElementList::Entry entry;
  };
  std::size_t num_away() const { return away_.size(); }
  std::vector<Away> take_away() { return std::exchange(away_, {}); }

  /// Takes one entry of the poor element list and applies the first rule that its cell violates. After a lock
  /// conflict conflicting_worker() returns the worker that holds the lock. Locks are held until release(),
  /// which must come before the next attempt. An exception (std::bad_alloc) leaves a valid triangulation and
  /// no lock, but may lose entries of the list.
  Outcome attempt();
  void release() { operation_.release(); }
  WorkerId conflicting_worker() const { return operation_.conflicting_worker(); }

  /// Locks of leaves are confined to the region of the leaf that the next attempts are for. New cells with a
  /// circumcenter elsewhere are kept apart.
  Locks& locks() { return operation_.locks(); }
  std::size_t num_foreign() const { return foreign_.size(); }
  std::vector<PoorElementList::Entry> take_foreign() { return std::exchange(foreign_, {}); }
  /// Cells of the leaf that need vertices outside its region.
  std::vector<PoorElementList::Entry> take_deferred() { return std::exchange(deferred_, {}); }

  /// Appends the buffered operations to the log.
  void flush_log();

  /// Counts of this worker, and its estimated real time of rollbacks, s; hops are in accesses().
  const Counters& counters() const { return operation_.counters(); }
  /// None if accesses are not counted.
  const std::optional<AccessTally>& accesses() const { return accesses_; }
  /// Requests so far by this worker, for its cells, vertices and list.
  SharedRequests shared_requests() const {
    return operation_.shared_requests() + SharedRequests{.new_bytes = poor_.mapped_bytes()};
  }
  /// The number of cells that this worker has added to the mesh, net.
  std::int64_t net_cells() const { return operation_.net_cells(); }

 private:
  static constexpr std::size_t kOperationsToFlush = 4096;
  // The number of attempts between the prefetch of a cell and its turn, and between that of its surroundings
  // and its turn.
  static constexpr std::size_t kTurnsToCell = 24, kTurnsToSurroundings = 8;
  // Reading the clock in every attempt costs 2 %. One attempt in this number stands for the others.
  static constexpr std::uint64_t kAttemptsForOneTimed = 16;

  static std::optional<AccessTally> tally_for(const Mesh& mesh);
  static std::optional<CountedReads> reads_for(std::optional<AccessTally>& tally, const ImageOwners* owners,
                                               NodeIndex node);
  Outcome attempt_next();
  void look_ahead();
  Outcome try_entry(const PoorElementList::Entry& entry);
  Outcome apply_first_rule(CellId c);
  Outcome apply_with_lines(CellId c);
  std::optional<Outcome> apply_r0(CellId c);
  std::optional<Outcome> split_line();
  StepResult plan_beside_lines(const Point& p, CellId start, std::optional<Outcome>& outcome);
  Outcome apply_r7(CellId c);
  Outcome insert_on_isosurface(const SurfacePoint& z, CellId start, Rule rule);
  bool is_covered(const Point& z) const;
  StepResult plan_r6_removals(const Point& z);
  double squared_reach_of_r6_near_lines(const Point& z) const;
  Outcome insert_circumcenter(const Point& p, CellId start, Rule rule);
  Outcome commit(const Point& p, VertexKind kind, Rule rule, SideMask sides = 0);
  [[gnu::noinline]] bool commit_in_box(const Point& p, VertexKind kind, SideMask sides);
  Outcome give_up();
  void make_room_in_log();
  void record_commit(const Point& p, VertexKind kind, SideMask sides);
  void log(const Point& p, VertexKind kind, SideMask sides);
  void list_created();

  Mesh& mesh_;
  std::optional<AccessTally> accesses_;
  const Isosurface& isosurface_;
  const Parameters& parameters_;
  const std::optional<CountedReads> reads_;
  Rules rules_;
  Operation<Locks> operation_;
  std::optional<LineKeeper<Locks>> lines_;           // none: no lines are kept
  std::optional<Perturbation<Locks>> perturbation_;  // none: R1 to R6 are applied
  PoorElementList poor_;
  std::vector<PoorElementList::Entry> foreign_, deferred_;
  const Homes* homes_ = nullptr;  // none: every cell is at home
  unsigned home_ = 0;
  std::vector<Away> away_;
  std::vector<Kept> kept_;
  double min_distance_;
  WorkerId self_;
  CommitOrder* order_;
  OperationBatch unlogged_;
};

extern template class Worker<NoLocks>;
extern template class Worker<VertexLocks>;

}  // namespace podm
