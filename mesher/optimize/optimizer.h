// A worker that improves bad cells, one per attempt. Like a worker of refinement it never blocks, spins or
// sleeps (refine/worker.h).
//
// An attempt looks for cells that replace some cells around a bad one. They are accepted only if the worst of
// them is better by a step (flips.h) than the worst before, and if all keep the bounds on ratio and size.
// They have one label, like the cells before, so no facet between labels changes, except by a peel (peel.h),
// which is only for cells beyond the bound.
//
// It terminates: bad new cells are listed again, and each is better by the step than the worst of the cells
// that it replaces. A chain of cells, each made in place of the one before, is therefore no longer than the
// number of steps to the aim. A cell that was given up is not tried again by the same means.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "optimize/cavity_search.h"
#include "optimize/flips.h"
#include "optimize/vertex_smoothing.h"
#include "podm/choices.h"
#include "podm/counters.h"
#include "refine/outcome.h"
#include "runtime/access_tally.h"
#include "sizing/size_field.h"

namespace podm {

inline constexpr std::size_t kNumMeans = Names<OptimizationMeans>::kAll.size();

struct OptimizerParameters {
  OptimizationQuality aim;  // a cell of quality 1 is good
  DihedralBounds bound;     // a cell whose quality by this bound is less than 1 is beyond it
  SizeField sizes;
  double delta_mm = 0;
};

/// The means of an attempt: flips and, if they do not help, moves and the named means.
struct OptimizerPass {
  OptimizationMeans means = OptimizationMeans::kFlips;
  bool is_for_cells_beyond_bound = false;  // other cells are given up at once
  unsigned max_search_steps = 0;
};

template <class Locks>
class Optimizer {
 public:
  struct Entry {
    CellId cell;
    std::uint32_t stamp;
  };

  Optimizer(Mesh& mesh, const OptimizerParameters& parameters, WorkerId self, Pool& pool);
  Optimizer(const Optimizer&) = delete;
  Optimizer& operator=(const Optimizer&) = delete;

  WorkerId id() const { return self_; }
  void begin(const OptimizerPass& pass) { pass_ = pass; }
  void give(const Entry& entry) { listed_.push_back(entry); }
  bool has_work() const { return !listed_.empty(); }
  /// Cells that were given up, that met locks of other workers, and that are still listed.
  std::vector<Entry> take_given_up() { return std::exchange(given_up_, {}); }
  std::vector<Entry> take_conflicts() { return std::exchange(conflicts_, {}); }
  std::vector<Entry> take_listed() { return std::exchange(listed_, {}); }

  /// Tries to improve the last listed cell. Locks are held until release(), which must come before the next
  /// attempt. An exception (std::bad_alloc) leaves a valid mesh and no lock, but may lose entries of the
  /// list.
  Outcome attempt();
  void release() { cavity_.release(); }

  const Counters& counters() const { return counters_; }
  /// None: accesses are not counted.
  const std::optional<AccessTally>& accesses() const { return accesses_; }
  const std::array<std::uint64_t, kNumMeans>& successes() const { return successes_; }
  std::int64_t net_cells() const { return cavity_.net_cells(); }
  /// The change of the hash of interfaces by peels (interface_hash.h).
  std::uint64_t interface_change() const { return interface_change_; }

 private:
  Outcome attempt_next();
  StepResult improve(CellId c);
  StepResult flip(OptimizationMeans means);
  StepResult move_a_vertex();
  StepResult move(VertexId v);
  StepResult search(OptimizationMeans means, bool adds_vertex);
  bool fill_cavity(OptimizationMeans means);
  void place_candidates();
  StepResult grow(std::size_t max_vertices, bool& has_grown);
  CellId cell_beside_cavity(std::size_t max_vertices);
  StepResult peel();
  StepResult peel_to(LabelIndex label);
  void commit(const std::vector<LocalCell>& cells, OptimizationMeans means);

  Mesh& mesh_;
  const OptimizerParameters& parameters_;
  WorkerId self_;
  Cavity<Locks> cavity_;
  Flips<Locks> flips_;
  VertexSmoothing smoothing_;
  CavitySearch search_;
  OptimizerPass pass_;
  std::vector<Entry> listed_, given_up_, conflicts_;
  Counters counters_;
  std::optional<AccessTally> accesses_;
  std::array<std::uint64_t, kNumMeans> successes_{};
  std::uint64_t interface_change_ = 0;
  // Data of the current attempt.
  AttemptedCell attempted_;
  std::vector<LocalCell> new_cells_;
  std::vector<LocalFacet> boundary_;
  std::vector<std::pair<VertexId, CellId>> beside_;
  std::vector<std::optional<Point>> candidates_;  // for a vertex that the search may add; none: for no vertex
};

extern template class Optimizer<NoLocks>;
extern template class Optimizer<VertexLocks>;

}  // namespace podm
