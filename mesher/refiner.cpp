#include "refiner.h"

#include <algorithm>
#include <boost/thread/scoped_thread.hpp>

#include "memory_model.h"
#include "refine/thread_executor.h"
#include "refine/virtual_box.h"
#include "refine/virtual_executor.h"
#include "report_on_workers.h"

namespace podm {

namespace {

// The phase in which store, pools, workers and threads are made ready.
constexpr const char* kAllocate = "allocate";

// The groups of the first workers alone.
WorkerGroups first_of(WorkerGroups groups, int num_workers) {
  for (std::vector<int>& level : groups)
    level.resize(std::min(level.size(), static_cast<std::size_t>(num_workers)));
  return groups;
}

std::vector<Place> part_of(const std::vector<Place>& places, std::size_t first, std::size_t count) {
  if (places.empty()) return {};
  const auto begin = places.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

Refiner::Refiner(const Problem& problem, const Box& clamp_box, const Crew& crew, Watch& watch)
    : problem_(problem), crew_(crew), watch_(watch) {
  timed(kAllocate, [&] {
    const int num_nodes = crew.machine != nullptr ? crew.machine->num_nodes() : 1;
    result_.mesh = std::make_unique<Mesh>(virtual_box(clamp_box), problem.cell_capacity, num_nodes);
    for (WorkerId worker = 0; worker < static_cast<WorkerId>(num_workers()); ++worker) {
      const Place place = place_of(worker);
      pools_.push_back(std::make_unique<Pool>(*result_.mesh, static_cast<NodeIndex>(place.node),
                                              static_cast<std::size_t>(num_workers())));
      result_.workers.push_back({place.node, place.socket, place.processor, {}, {}});
      accesses_.push_back({place.node, {}});
    }
  });
}

Refiner::Entries Refiner::all_cells() const {
  Entries cells;
  for (CellId c = 0; c < mesh().cell_bound(); ++c)
    if (mesh().cell(c).is_alive()) cells.push_back({c, mesh().stamp(c)});
  return cells;
}

CoordinationOptions Refiner::coordination(int num_workers) const {
  CoordinationOptions options = crew_.coordination;
  options.num_workers = num_workers;
  options.groups = first_of(options.groups, num_workers);
  return options;
}

// A computing node is one group.
CoordinationOptions Refiner::node_coordination(int num_nodes) const {
  CoordinationOptions options = crew_.coordination;
  options.num_workers = num_workers() / num_nodes;
  options.groups.clear();
  return options;
}

template <class Locks>
Refiner::Workers<Locks> Refiner::make_workers(const Parameters& parameters, int num_workers) {
  Workers<Locks> workers;
  timed(kAllocate, [&] {
    for (WorkerId id = 0; id < static_cast<WorkerId>(num_workers); ++id)
      workers.push_back(std::make_unique<Worker<Locks>>(*result_.mesh, problem_.isosurface, parameters, id,
                                                        *pools_[id], crew_.log, crew_.owners));
  });
  return workers;
}

template <class Locks>
void Refiner::account(const Worker<Locks>& worker, WorkerId id, const Overhead& overhead) {
  add(counters_of(worker, overhead, place_of(id), crew_.machine), result_.workers[id].counters);
  if (worker.accesses()) accesses_[id].addresses = worker.accesses()->samples();
}

void Refiner::sample_pages(const std::string& phase) {
  if (crew_.pages == nullptr) return;
  crew_.pages->sample(phase, mesh(), accesses_, result_.pages);
  for (SampledAccesses& of_worker : accesses_) of_worker.addresses.clear();
}

// All workers start at once; those without cells beg until the first has some to share.
void Refiner::refine_anywhere(const std::string& phase, const Parameters& parameters, const Entries& cells,
                              int num_workers) {
  if (is_over()) return timed(phase, [] {});  // every run has this phase
  const auto refine = [&](auto& workers, const auto& run, const auto& overhead_of) {
    workers[0]->give(cells);
    run();
    for (WorkerId id = 0; id < workers.size(); ++id) {
      workers[id]->flush_log();
      account(*workers[id], id, overhead_of(id));
    }
  };
  timed(phase, [&] {
    if (crew_.executor == Executor::kVirtual) {
      auto workers = make_workers<VertexLocks>(parameters, num_workers);
      VirtualExecutor<VertexLocks> executor(watch_, coordination(num_workers), crew_.cost);
      refine(
          workers, [&] { return executor.run(workers); }, [&](WorkerId id) { return executor.overhead(id); });
      result_.virtual_phases_s[phase] += executor.elapsed_s();
    } else if (num_workers > 1 || crew_.locks_alone) {
      auto workers = make_workers<VertexLocks>(parameters, num_workers);
      ThreadExecutor<VertexLocks> executor(watch_, coordination(num_workers), crew_.places);
      refine(
          workers, [&] { return executor.run(workers); }, [&](WorkerId id) { return executor.overhead(id); });
      charge(kAllocate, executor.start_s());
      for (WorkerId id = 0; id < workers.size(); ++id)
        result_.workers[id].bound_to = executor.processor(id).bound_to;
    } else {
      const ScopedBinding binding(place_of(0).processor);
      auto workers = make_workers<NoLocks>(parameters, 1);
      refine(
          workers, [&] { return SerialExecutor(watch_).run(*workers[0]); },
          [](WorkerId) { return Overhead{}; });
      result_.workers[0].bound_to = processor_of_this_thread().bound_to;
    }
  });
  sample_pages(phase);
}

// Each node on its threads; the first node's master is the calling thread. What goes by before it refines is
// allocation, though other nodes may have begun.
template <class Locks>
void Refiner::run_on_threads(const CoordinationOptions& options, std::vector<ComputingNode<Locks>>& nodes) {
  std::vector<std::exception_ptr> failures(nodes.size());
  double start_s = 0;
  const auto run = [&](std::size_t n) {
    const std::size_t per_node = nodes[n].workers().size(), first = n * per_node;
    try {
      ThreadExecutor<Locks> executor(watch_, options, part_of(crew_.places, first, per_node),
                                     static_cast<WorkerId>(first));
      executor.run(nodes[n].workers(), &nodes[n]);
      if (n == 0) start_s += executor.start_s();
      for (WorkerId i = 0; i < per_node; ++i) {
        account(*nodes[n].workers()[i], static_cast<WorkerId>(first) + i, executor.overhead(i));
        result_.workers[first + i].bound_to = executor.processor(i).bound_to;
      }
    } catch (...) {
      failures[n] = std::current_exception();
      watch_.end(StopReason::kCancelled);
    }
  };
  {
    std::vector<boost::scoped_thread<>> masters;
    try {
      timed(kAllocate, [&] {
        for (std::size_t n = 1; n < nodes.size(); ++n) masters.emplace_back([&run, n] { run(n); });
      });
      run(0);
    } catch (...) {  // a thread was not to be had: those that run already end now
      watch_.end(StopReason::kCancelled);
      throw;
    }
  }
  charge(kAllocate, start_s);
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

template <class Locks, class RunNodes>
Refiner::Entries Refiner::run_leaves(const Parameters& parameters, const Octree& octree, int num_nodes,
                                     bool with_schedule, std::function<double()> clock,
                                     const RunNodes& run_nodes) {
  auto workers = make_workers<Locks>(parameters, num_workers());
  LeafRefinement leaves(mesh(), octree, static_cast<unsigned>(num_nodes), all_cells(), std::move(clock),
                        watch_.over());
  const std::size_t per_node = workers.size() / static_cast<std::size_t>(num_nodes);
  std::vector<ComputingNode<Locks>> nodes;
  for (unsigned node = 0; node < static_cast<unsigned>(num_nodes); ++node)
    nodes.emplace_back(leaves, node, std::span(workers).subspan(node * per_node, per_node));
  if (with_schedule) {
    for (const auto& worker : workers) worker->locks().watch_leaves();
  }
  run_nodes(std::span<const std::unique_ptr<Worker<Locks>>>(workers), nodes);
  for (ComputingNode<Locks>& node : nodes) node.finish_leaf();  // of those that ended early
  for (const auto& worker : workers) worker->flush_log();
  if (with_schedule) result_.schedule.emplace().activations = leaves.take_schedule();
  return leaves.take_leftover();
}

template <class Locks>
Refiner::Entries Refiner::refine_leaves_in_virtual_time(const std::string& phase,
                                                        const Parameters& parameters, const Octree& octree,
                                                        int num_nodes, bool with_schedule) {
  VirtualExecutor<Locks> executor(watch_, node_coordination(num_nodes), crew_.cost, num_nodes);
  const auto run = [&](auto workers, std::vector<ComputingNode<Locks>>& nodes) {
    std::vector<CellSource*> sources;
    for (auto& node : nodes) sources.push_back(&node);
    executor.run(workers, sources);
    for (WorkerId id = 0; id < workers.size(); ++id) account(*workers[id], id, executor.overhead(id));
  };
  Entries left = run_leaves<Locks>(
      parameters, octree, num_nodes, with_schedule, [&] { return executor.elapsed_s(); }, run);
  result_.virtual_phases_s[phase] += executor.elapsed_s();
  return left;
}

template <class Locks>
Refiner::Entries Refiner::refine_leaves(const std::string& phase, const Parameters& parameters,
                                        const Octree& octree, int num_nodes, bool with_schedule) {
  Entries left;
  timed(phase, [&] {
    if (is_over()) return;
    result_.num_leaves = octree.num_leaves();
    if (crew_.executor == Executor::kVirtual) {
      left = refine_leaves_in_virtual_time<Locks>(phase, parameters, octree, num_nodes, with_schedule);
      return;
    }
    const auto start = std::chrono::steady_clock::now();
    const auto clock = [start] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const auto run = [&](auto, std::vector<ComputingNode<Locks>>& nodes) {
      run_on_threads(node_coordination(num_nodes), nodes);
    };
    left = run_leaves<Locks>(parameters, octree, num_nodes, with_schedule, clock, run);
  });
  sample_pages(phase);
  return left;
}

template Refiner::Entries Refiner::refine_leaves<LeafLocks<NoLocks>>(const std::string&, const Parameters&,
                                                                     const Octree&, int, bool);
template Refiner::Entries Refiner::refine_leaves<LeafLocks<VertexLocks>>(const std::string&,
                                                                         const Parameters&, const Octree&,
                                                                         int, bool);

void Refiner::withhold(std::uint64_t bytes) {
  const std::uint64_t cells = (bytes + kBytesPerStoredCell - 1) / kBytesPerStoredCell;
  if (!result_.mesh->withhold(cells)) watch_.end(StopReason::kMemoryLimit);
}

// Memory may be left where there are no more numbers for cells.
Refinement Refiner::finish() {
  result_.stop_reason = watch_.reason();
  if (result_.stop_reason == StopReason::kMemoryLimit && mesh().is_used_up() &&
      problem_.cell_capacity >= problem_.most_numbered_cells)
    result_.stop_reason = StopReason::kNumberLimit;
  result_.counters = sum_of(result_.workers);
  return std::move(result_);
}

}  // namespace podm
