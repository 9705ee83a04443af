// A worker: one refinement agent with its own poor element list, pool and counters. It does one operation at
// a time and never blocks, spins or sleeps; the loop in algorithms/podm_loop.h decides when it runs.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "delaunay/operation.h"
#include "podm/operation_log.h"
#include "refine/homes.h"
#include "refine/outcome.h"
#include "refine/perturbation.h"
#include "refine/poor_element_list.h"
#include "refine/rules.h"

namespace podm {

template <class Locks>
class Worker {
 public:
  /// `log`, if given, learns of every commit. `owners` of the image, if given and known, let its reads be
  /// counted too; accesses are counted where the mesh lies on several nodes.
  Worker(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters, WorkerId self, Pool& pool,
         OperationLogWriter* log = nullptr, const ImageOwners* owners = nullptr);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  WorkerId id() const { return self_; }
  void give(CellId c) { poor_.push(c, mesh_.stamp(c)); }
  void give(const std::vector<PoorElementList::Entry>& entries) {
    for (const auto& entry : entries) poor_.push(entry.cell, entry.stamp);
  }
  bool has_work() const { return !poor_.is_empty(); }
  std::size_t num_listed() const { return poor_.size(); }
  /// Takes the oldest cells off the list, for another worker; about half of them, at most `max`.
  std::vector<PoorElementList::Entry> share(std::size_t max) { return poor_.take_oldest(max, mesh_); }

  /// From now on new cells whose home is another are kept apart, for others to refine. The homes must outlive
  /// this.
  void keep_to(const Homes& homes, unsigned home) {
    homes_ = &homes;
    home_ = home;
  }
  /// From now on R7 alone is applied, to a mesh that breaks no other rule. `seed` draws where to vertices
  /// move.
  void perturb(const DihedralBounds& bounds, std::uint64_t seed);
  Perturbation<Locks>& perturbation() { return *perturbation_; }
  /// A poor cell that R7 could not change.
  struct Kept {
    PoorElementList::Entry entry;
    Unmoved why;
  };
  /// Some may be stale.
  std::vector<Kept> take_kept() { return std::exchange(kept_, {}); }

  struct Away {
    unsigned home;
    PoorElementList::Entry entry;
  };
  std::size_t num_away() const { return away_.size(); }
  std::vector<Away> take_away() { return std::exchange(away_, {}); }

  /// Takes one entry of the poor element list and applies the first rule that its cell breaks.
  /// After a conflict conflicting_worker() tells with whom. Locks are held until release(), which must come
  /// before the next attempt. What is thrown (std::bad_alloc) leaves a valid triangulation and no lock, but
  /// may lose entries of the list.
  Outcome attempt();
  void release() { operation_.release(); }
  WorkerId conflicting_worker() const { return operation_.conflicting_worker(); }

  /// Confined to the region of the leaf that the next attempts are for; new cells whose circumcentre is
  /// elsewhere are kept apart.
  Locks& locks() { return operation_.locks(); }
  std::size_t num_foreign() const { return foreign_.size(); }
  std::vector<PoorElementList::Entry> take_foreign() { return std::exchange(foreign_, {}); }
  /// Cells of the leaf that need vertices outside its region.
  std::vector<PoorElementList::Entry> take_deferred() { return std::exchange(deferred_, {}); }

  /// Hands the last operations to the log.
  void flush_log();

  /// What it counts itself, and the seconds of rollback in real time, estimated; hops are in accesses().
  const Counters& counters() const { return operation_.counters(); }
  /// None where nothing is counted.
  const std::optional<AccessTally>& accesses() const { return accesses_; }
  /// Cells this worker has added to the mesh, net.
  std::int64_t net_cells() const { return operation_.net_cells(); }

 private:
  // Invariants keep vertices s apart, to a thousandth at a time (rules.h). Only an oracle that errs about the
  // nearest point can bring them much closer; far below s the insertion is refused, so that the process ends
  // whatever the image.
  static constexpr double kSpacingFloor = 0.1;
  static constexpr std::size_t kOperationsToFlush = 4096;
  // Attempts between the look ahead for a cell, for what lies around it, and its turn.
  static constexpr std::size_t kTurnsToCell = 24, kTurnsToSurroundings = 8;
  // A clock costs 2 % when every attempt reads it; one in so many stands for the others.
  static constexpr std::uint64_t kAttemptsForOneTimed = 16;

  static std::optional<AccessTally> tally_for(const Mesh& mesh);
  static std::optional<CountedReads> reads_for(std::optional<AccessTally>& tally, const ImageOwners* owners,
                                               NodeIndex node);
  Outcome attempt_next();
  void look_ahead();
  Outcome try_entry(const PoorElementList::Entry& entry);
  Outcome apply_first_rule(CellId c);
  Outcome apply_r7(CellId c);
  Outcome insert_on_isosurface(const Point& z, CellId start, Rule rule);
  bool is_covered(const Point& z) const;
  StepResult plan_r6_removals(const Point& z);
  Outcome insert_circumcenter(const Point& p, CellId start, Rule rule);
  Outcome commit(const Point& p, VertexKind kind, Rule rule);
  Outcome give_up();
  void make_room_in_log();
  void tell_of_commit(const Point& p, VertexKind kind);
  void log(const Point& p, VertexKind kind);
  void list_created();

  Mesh& mesh_;
  std::optional<AccessTally> accesses_;
  const Isosurface& isosurface_;
  const Parameters& parameters_;
  const std::optional<CountedReads> reads_;
  Rules rules_;
  Operation<Locks> operation_;
  std::optional<Perturbation<Locks>> perturbation_;  // none: R1 to R6
  PoorElementList poor_;
  std::vector<PoorElementList::Entry> foreign_, deferred_;
  const Homes* homes_ = nullptr;  // none: all cells are at home
  unsigned home_ = 0;
  std::vector<Away> away_;
  std::vector<Kept> kept_;
  double min_distance_;
  WorkerId self_;
  OperationLogWriter* log_;
  OperationBatch unlogged_;
};

extern template class Worker<NoLocks>;
extern template class Worker<VertexLocks>;

}  // namespace podm
