#include "podm.h"

#include <algorithm>
#include <cmath>

#include "refine/virtual_box.h"

namespace podm {

namespace {

Counters gather(const Worker<NoLocks>& worker) {
  const WorkerCounters& w = worker.counters();
  const OperationCounters& o = worker.operation_counters();
  return {w.insertions_by_rule, w.removals,       w.rejected,        w.stale_cells,
          w.classified_cells,   o.conflict_tests, o.exact_decisions, o.cells_created};
}

}  // namespace

Refinement podm(const Isosurface& isosurface, const Box& object, double delta_mm, const SizeField& sizes,
                std::size_t cell_capacity, SerialExecutor& executor) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  const double spacing_mm = std::min(delta_mm, std::sqrt(sizes.smallest_squared_radius()) / k);
  const Parameters parameters{delta_mm, sizes, clamp_box(object, delta_mm), spacing_mm};

  Refinement result;
  result.mesh = std::make_unique<Mesh>(virtual_box(parameters.clamp_box), cell_capacity);
  Worker<NoLocks> worker(*result.mesh, isosurface, parameters);
  for (CellId c = 0; c < result.mesh->cell_bound(); ++c) worker.give(c);
  result.stop_reason = executor.run(worker, *result.mesh);
  result.counters = gather(worker);
  return result;
}

}  // namespace podm
