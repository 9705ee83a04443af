#include "algorithms/construction.h"

#include "algorithms/leaf_locks.h"
#include "algorithms/memory_model.h"
#include "algorithms/report_on_workers.h"
#include "refine/virtual_box.h"
#include "workers/work_cost.h"

namespace podm {

Construction::Construction(const Problem& problem, const Box& clamp_box, const Team& team, StopControl& stop)
    : problem_(problem), team_(team), stop_(stop) {
  timed(kAllocate, [&] {
    const int num_nodes = team.machine != nullptr ? team.machine->num_nodes() : 1;
    result_.mesh = std::make_unique<Mesh>(virtual_box(clamp_box), problem.cell_capacity, num_nodes);
    for (WorkerId worker = 0; worker < static_cast<WorkerId>(num_workers()); ++worker) {
      const Place place = place_of(worker);
      pools_.push_back(std::make_unique<Pool>(*result_.mesh, static_cast<NodeIndex>(place.node),
                                              static_cast<std::size_t>(num_workers())));
      result_.workers.push_back({.node = place.node,
                                 .socket = place.socket,
                                 .processor = place.processor,
                                 .bound_to = {},
                                 .counters = {}});
      accesses_.push_back({.node = place.node, .addresses = {}});
    }
  });
  charge_virtual(kAllocate, kThreadStarted * (num_workers() - 1));
}

Construction::Entries Construction::all_cells() const {
  Entries cells;
  for (CellId c = 0; c < mesh().cell_bound(); ++c)
    if (mesh().cell(c).is_alive()) cells.push_back({c, mesh().stamp(c)});
  return cells;
}

void Construction::withhold(std::uint64_t bytes) {
  const std::uint64_t cells = (bytes + kBytesPerStoredCell - 1) / kBytesPerStoredCell;
  if (!result_.mesh->withhold(cells)) stop_.end(StopReason::kMemoryLimit);
}

template <class Locks>
Construction::Workers<Locks> Construction::make_workers(const Parameters& parameters, int num_workers) {
  Workers<Locks> workers;
  timed(kAllocate, [&] {
    for (WorkerId id = 0; id < static_cast<WorkerId>(num_workers); ++id)
      workers.push_back(std::make_unique<Worker<Locks>>(*result_.mesh, problem_.isosurface, parameters, id,
                                                        *pools_[id], team_.log, team_.owners));
  });
  return workers;
}

std::vector<Place> Construction::places_of_first(std::size_t count) const {
  if (team_.places.empty()) return {};
  return {team_.places.begin(), team_.places.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::vector<NodeIndex> Construction::nodes_of_first(std::size_t count) const {
  std::vector<NodeIndex> nodes;
  for (WorkerId worker = 0; worker < count; ++worker)
    nodes.push_back(static_cast<NodeIndex>(place_of(worker).node));
  return nodes;
}

template <class Locks>
void Construction::add_counters(const Worker<Locks>& worker, const Overhead& overhead) {
  const WorkerId id = worker.id();
  add(counters_of(worker, overhead, place_of(id), team_.machine), result_.workers[id].counters);
  if (worker.accesses()) accesses_[id].addresses = worker.accesses()->samples();
}

void Construction::sample_pages(const std::string& phase) {
  if (team_.pages == nullptr) return;
  team_.pages->sample(phase, mesh(), accesses_, result_.pages);
  for (SampledAccesses& of_worker : accesses_) of_worker.addresses.clear();
}

// Before the team goes on, so that operations on vertices come after their moves.
void Construction::log(const Relocation& relocation) {
  OperationBatch moves;
  for (VertexId v = 0; v < relocation.vertex_bound(); ++v) {
    const VertexId now = relocation.vertex_now(v);
    if (now == v) continue;
    const Point& p = mesh().point(now);
    moves.operations.push_back({.sequence = team_.log->next_sequence(),
                                .point = {p.x, p.y, p.z},
                                .vertex = now,
                                .worker = 0,
                                .kind = kMovedVertex,
                                .num_removed = 1});
    moves.removed.push_back(v);
  }
  team_.log->append(moves);
}

// Memory may be left where there are no more numbers for cells.
Refinement Construction::finish() {
  result_.stop_reason = stop_.reason();
  if (result_.stop_reason == StopReason::kMemoryLimit && mesh().is_used_up() &&
      problem_.cell_capacity >= problem_.most_numbered_cells)
    result_.stop_reason = StopReason::kNumberLimit;
  result_.counters = sum_of(result_.workers);
  return std::move(result_);
}

template Construction::Workers<NoLocks> Construction::make_workers<NoLocks>(const Parameters&, int);
template Construction::Workers<VertexLocks> Construction::make_workers<VertexLocks>(const Parameters&, int);
template Construction::Workers<LeafLocks<NoLocks>> Construction::make_workers<LeafLocks<NoLocks>>(
    const Parameters&, int);
template Construction::Workers<LeafLocks<VertexLocks>> Construction::make_workers<LeafLocks<VertexLocks>>(
    const Parameters&, int);
template void Construction::add_counters(const Worker<NoLocks>&, const Overhead&);
template void Construction::add_counters(const Worker<VertexLocks>&, const Overhead&);
template void Construction::add_counters(const Worker<LeafLocks<NoLocks>>&, const Overhead&);
template void Construction::add_counters(const Worker<LeafLocks<VertexLocks>>&, const Overhead&);

}  // namespace podm
