#include "algorithms/construction.h"

#include "algorithms/memory_model.h"
#include "refine/virtual_box.h"
#include "runtime/virtual_threads.h"

namespace podm {

Construction::Construction(const Problem& problem, const Box& clamp_box, const Team& team, StopControl& stop)
    : problem_(problem), team_(team), stop_(stop) {
  timed(kAllocate, [&] {
    const int num_nodes = team.machine != nullptr ? team.machine->num_nodes() : 1;
    result_.mesh = std::make_unique<Mesh>(virtual_box(clamp_box), problem.cell_capacity, num_nodes,
                                          problem.shared_cells);
    if (team.log != nullptr)
      order_ =
          std::make_unique<CommitOrder>(*result_.mesh, *team.log, static_cast<std::size_t>(num_workers()));
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
    return starting_threads(num_workers());
  });
}

// On a rank in virtual time the schedule of virtual time decides how busy the workers are. The processor
// seconds of their work are those that it took here. Threads would also have to be started.
void Construction::note_virtual_time(const std::string& phase, const VirtualTime& time) {
  result_.virtual_phases_s[phase] += time.now_s();
  result_.virtual_spending += time.spending();
  VirtualThreads* const threads = VirtualThreads::current();
  if (threads == nullptr || time.busy_s() == 0) return;
  const double start_s = (num_workers() - 1) * TimeCosts().thread_started;
  threads->replace(time.processor_s(), start_s + time.processor_s() * time.now_s() / time.busy_s());
}

Construction::Entries Construction::all_cells() const {
  Entries cells;
  for (CellId c = 0; c < mesh().cell_bound(); ++c)
    if (mesh().cell(c).is_alive()) cells.push_back({c, mesh().stamp(c)});
  return cells;
}

void Construction::reduce_capacity(std::uint64_t bytes) {
  const std::uint64_t cells = (bytes + kBytesPerStoredCell - 1) / kBytesPerStoredCell;
  if (!result_.mesh->reduce_capacity(cells)) stop_.end(StopReason::kMemoryLimit);
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

void Construction::sample_pages(const std::string& phase) {
  if (team_.pages == nullptr) return;
  team_.pages->sample(phase, mesh(), accesses_, result_.pages);
  for (SampledAccesses& of_worker : accesses_) of_worker.addresses.clear();
}

// Called before the team goes on, so that operations on vertices come after the vertices' moves.
void Construction::log(const Relocation& relocation) {
  OperationBatch moves;
  for (VertexId v = 0; v < relocation.vertex_bound(); ++v) {
    const VertexId now = relocation.vertex_now(v);
    if (now == v) continue;
    const Point& p = mesh().point(now);
    moves.operations.push_back({.sequence = 0,
                                .point = {p.x, p.y, p.z},
                                .vertex = now,
                                .worker = 0,
                                .kind = kMovedVertex,
                                .num_removed = 1});
    moves.removed.push_back(v);
  }
  std::uint64_t sequence = order_->next_between_operations(moves.operations.size());
  for (LoggedOperation& move : moves.operations) move.sequence = sequence++;
  order_->log().append(moves);
}

// Distinguishes a store without memory from one without cell numbers, which may have memory left.
Refinement Construction::finish() {
  result_.stop_reason = stop_.reason();
  if (result_.stop_reason == StopReason::kMemoryLimit && mesh().is_exhausted() &&
      problem_.cell_capacity >= problem_.most_numbered_cells)
    result_.stop_reason = StopReason::kNumberLimit;
  result_.counters = sum_of(result_.workers);
  return std::move(result_);
}

}  // namespace podm
