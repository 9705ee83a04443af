#include "podm.h"

#include <algorithm>
#include <cmath>

#include "refine/thread_executor.h"
#include "refine/virtual_box.h"
#include "refine/virtual_executor.h"

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
}

void add(const Overhead& overhead, Counters& sum) {
  sum.contention_s += overhead.contention_s;
  sum.begging_s += overhead.begging_s;
  sum.rollback_s += overhead.rollback_s;
}

template <class Locks>
void give_all_cells(const Mesh& mesh, Worker<Locks>& worker) {
  for (CellId c = 0; c < mesh.cell_bound(); ++c) worker.give(c);
}

// All workers start at once; those without cells beg until the first has some to share.
template <class AnyExecutor>
void refine_in_parallel(AnyExecutor& executor, const Isosurface& isosurface, const Parameters& parameters,
                        const Crew& crew, Refinement& result) {
  typename AnyExecutor::Workers workers;
  for (WorkerId i = 0; i < static_cast<WorkerId>(crew.coordination.num_workers); ++i) {
    workers.push_back(
        std::make_unique<Worker<VertexLocks>>(*result.mesh, isosurface, parameters, i, crew.log));
  }
  give_all_cells(*result.mesh, *workers[0]);
  result.stop_reason = executor.run(workers);
  for (WorkerId i = 0; i < workers.size(); ++i) {
    workers[i]->flush_log();
    add(*workers[i], result.counters);
    add(executor.overhead(i), result.counters);
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
  if (crew.executor == Executor::kVirtual) {
    VirtualExecutor executor(watch, crew.coordination, crew.cost);
    refine_in_parallel(executor, isosurface, parameters, crew, result);
    result.virtual_s = executor.elapsed_s();
  } else if (crew.coordination.num_workers > 1 || crew.locks_alone) {
    ThreadExecutor executor(watch, crew.coordination);
    refine_in_parallel(executor, isosurface, parameters, crew, result);
  } else {
    Worker<NoLocks> worker(*result.mesh, isosurface, parameters, 0, crew.log);
    give_all_cells(*result.mesh, worker);
    result.stop_reason = SerialExecutor(watch).run(worker);
    worker.flush_log();
    add(worker, result.counters);
  }
  return result;
}

}  // namespace podm
