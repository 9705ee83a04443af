#include "podm.h"

#include <algorithm>
#include <cmath>

#include "refine/thread_executor.h"
#include "refine/virtual_box.h"
#include "refine/virtual_executor.h"
#include "report_on_workers.h"

namespace podm {

namespace {

int num_nodes(const Crew& crew) { return crew.machine != nullptr ? crew.machine->num_nodes() : 1; }

Place place_of(const Crew& crew, WorkerId worker) {
  return crew.places.empty() ? Place{} : crew.places[worker];
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
    workers.push_back(std::make_unique<Worker<VertexLocks>>(
        *result.mesh, isosurface, parameters, i, static_cast<NodeIndex>(place_of(crew, i).node), crew.log));
  }
  give_all_cells(*result.mesh, *workers[0]);
  result.stop_reason = executor.run(workers);
  for (WorkerId i = 0; i < workers.size(); ++i) {
    workers[i]->flush_log();
    result.workers.push_back(report_on(*workers[i], executor.overhead(i), place_of(crew, i), crew.machine));
  }
}

}  // namespace

Refinement podm(const Isosurface& isosurface, const Box& object, double delta_mm, const SizeField& sizes,
                std::size_t cell_capacity, const Crew& crew, Watch& watch) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  const double spacing_mm = std::min(delta_mm, std::sqrt(sizes.smallest_squared_radius()) / k);
  const Parameters parameters{delta_mm, sizes, clamp_box(object, delta_mm), spacing_mm};

  Refinement result;
  result.mesh = std::make_unique<Mesh>(virtual_box(parameters.clamp_box), cell_capacity, num_nodes(crew));
  if (crew.executor == Executor::kVirtual) {
    VirtualExecutor executor(watch, crew.coordination, crew.cost);
    refine_in_parallel(executor, isosurface, parameters, crew, result);
    result.virtual_s = executor.elapsed_s();
  } else if (crew.coordination.num_workers > 1) {
    ThreadExecutor executor(watch, crew.coordination, crew.places);
    refine_in_parallel(executor, isosurface, parameters, crew, result);
    for (WorkerId i = 0; i < result.workers.size(); ++i)
      result.workers[i].bound_to = executor.processor(i).bound_to;
  } else {
    const ScopedBinding binding(place_of(crew, 0).processor);
    Worker<NoLocks> worker(*result.mesh, isosurface, parameters, 0, 0, crew.log);
    give_all_cells(*result.mesh, worker);
    result.stop_reason = SerialExecutor(watch).run(worker);
    worker.flush_log();
    result.workers.push_back(report_on(worker, {}, place_of(crew, 0), crew.machine));
    result.workers.back().bound_to = processor_of_this_thread().bound_to;
  }
  result.counters = sum_of(result.workers);
  return result;
}

}  // namespace podm
