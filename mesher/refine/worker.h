// A worker: one refinement agent with its own poor element list, pool and counters. It does one operation at
// a time and never blocks, spins or sleeps; executors decide when it runs.
#pragma once

#include <array>
#include <cstdint>

#include "delaunay/operation.h"
#include "refine/poor_element_list.h"
#include "refine/rules.h"

namespace podm {

struct WorkerCounters {
  std::array<std::uint64_t, 5> insertions_by_rule{};
  std::uint64_t removals = 0, rejected = 0, stale_cells = 0, classified_cells = 0;
};

template <class Locks>
class Worker {
 public:
  Worker(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters);

  void give(CellId c) { poor_.push(c, mesh_.state(c).stamp); }
  bool has_work() const { return !poor_.is_empty(); }
  /// Takes one entry of the poor element list and applies the first rule that its cell breaks.
  void attempt();

  const WorkerCounters& counters() const { return counters_; }
  const OperationCounters& operation_counters() const { return operation_.counters(); }
  /// Cells this worker has added to the mesh, net.
  std::int64_t net_cells() const {
    return static_cast<std::int64_t>(operation_.counters().cells_created) -
           static_cast<std::int64_t>(operation_.counters().cells_destroyed);
  }

 private:
  enum class Sampled { kNo, kCovered, kYes };
  void apply_first_rule(CellId c);
  Sampled insert_on_isosurface(const Point& z, CellId start, Rule rule);
  void insert_circumcenter(const Point& p, CellId start, Rule rule);
  Sampled commit(const Point& p, VertexKind kind, Rule rule);
  Sampled give_up();

  Mesh& mesh_;
  Rules rules_;
  Pool pool_;
  Operation<Locks> operation_;
  PoorElementList poor_;
  WorkerCounters counters_;
  double min_distance_;
};

extern template class Worker<NoLocks>;

}  // namespace podm
