#include "podm.h"

#include <algorithm>
#include <cmath>

#include "refine/thread_executor.h"
#include "refine/virtual_box.h"

namespace podm {

namespace {

template <class Locks>
void add(const Worker<Locks>& worker, Counters& sum) {
  const WorkerCounters& w = worker.counters();
  const OperationCounters& o = worker.operation_counters();
  for (std::size_t rule = 0; rule < sum.insertions_by_rule.size(); ++rule)
    sum.insertions_by_rule[rule] += w.insertions_by_rule[rule];
  sum.removals += w.removals;
  sum.rejected += w.rejected;
  sum.stale_cells += w.stale_cells;
  sum.classified_cells += w.classified_cells;
  sum.conflict_tests += o.conflict_tests;
  sum.exact_decisions += o.exact_decisions;
  sum.cells_created += o.cells_created;
  sum.lock_conflicts += w.lock_conflicts;
  sum.rollback_s += std::chrono::duration<double>(w.rollback).count();
}

template <class Locks>
void give_all_cells(const Mesh& mesh, Worker<Locks>& worker) {
  for (CellId c = 0; c < mesh.cell_bound(); ++c) worker.give(c);
}

// All threads start at once; those without cells beg until the first has some to share.
void refine_in_parallel(const Isosurface& isosurface, const Parameters& parameters, const Crew& crew,
                        Watch& watch, Refinement& result) {
  ThreadExecutor::Workers workers;
  for (int i = 0; i < crew.threads; ++i) {
    workers.push_back(std::make_unique<Worker<VertexLocks>>(*result.mesh, isosurface, parameters,
                                                            static_cast<WorkerId>(i)));
  }
  give_all_cells(*result.mesh, *workers[0]);
  ThreadExecutor executor(watch, crew.threads, crew.contention, crew.seed);
  result.stop_reason = executor.run(workers, *result.mesh);
  for (WorkerId i = 0; i < workers.size(); ++i) {
    add(*workers[i], result.counters);
    result.counters.contention_s += executor.idleness(i).contention_s;
    result.counters.begging_s += executor.idleness(i).begging_s;
  }
}

}  // namespace

Refinement podm(const Isosurface& isosurface, const Box& object, double delta_mm, const SizeField& sizes,
                std::size_t cell_capacity, const Crew& crew, Watch& watch) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  const double spacing_mm = std::min(delta_mm, std::sqrt(sizes.smallest_squared_radius()) / k);
  const Parameters parameters{delta_mm, sizes, clamp_box(object, delta_mm), spacing_mm};

  Refinement result;
  result.mesh = std::make_unique<Mesh>(virtual_box(parameters.clamp_box), cell_capacity);
  if (crew.threads > 1) {
    refine_in_parallel(isosurface, parameters, crew, watch, result);
  } else {
    Worker<NoLocks> worker(*result.mesh, isosurface, parameters, 0);
    give_all_cells(*result.mesh, worker);
    result.stop_reason = SerialExecutor(watch).run(worker, *result.mesh);
    add(worker, result.counters);
  }
  return result;
}

}  // namespace podm
