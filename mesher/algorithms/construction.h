// A mesh under construction: its store, the pools of its workers, and the time that each phase took.
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "algorithms/page_sampler.h"
#include "algorithms/report_on_workers.h"
#include "delaunay/commit_order.h"
#include "delaunay/relocation.h"
#include "geometry/dihedral.h"
#include "podm/limits.h"
#include "podm/meshing_report.h"
#include "podm/topology_report.h"
#include "refine/rules.h"
#include "refine/worker.h"
#include "runtime/placement.h"
#include "sizing/thin_layers.h"
#include "workers/accounting.h"
#include "workers/coordination.h"
#include "workers/real_time.h"
#include "workers/virtual_time.h"

namespace podm {

struct Problem {
  const Isosurface& isosurface;
  Box object;  // bounds of the foreground
  double delta_mm = 0;
  SizeField sizes;
  std::size_t cell_capacity = 0;      // the most cells that the store may hold
  SharedIds* shared_cells = nullptr;  // from which it takes them; null: it has them alone
  // Bytes that store, workers and leaves may take together. The capacity accounts for workers, not for
  // leaves.
  std::uint64_t memory_bytes = std::numeric_limits<std::uint64_t>::max();
  // A full store of this capacity has run out of cell numbers, not of memory. Tests set a lower value.
  std::size_t most_numbered_cells = kMostStoredCells;
  std::optional<DihedralBounds> dihedral_bounds = {};  // for R7; none: R7 is not requested
  std::shared_ptr<const DeltaField> deltas = nullptr;  // null: delta_mm everywhere
  const ThinLayers* thin = nullptr;                    // that these deltas keep; null: none is kept
  const Lines* lines = nullptr;                        // to keep as edges; null: none
  double lines_delta_mm = 0;                           // distance at which they are sampled
  const LineNetwork* box_curves = nullptr;             // on the sides of a flat box; null: the box is open
  /// Receives R7's progress, from 0 to 1, and the number of cells in the store.
  std::function<void(double fraction, std::uint64_t cells)> observe_perturbation = {};
};

/// The workers of a run.
struct Team {
  Executor executor = Executor::kThreads;
  CoordinationOptions coordination;
  int num_nodes = 1;        // computing nodes, which divide the workers evenly; PODM has one
  int initial_workers = 1;  // workers that make the initial mesh
  VirtualCost cost = VirtualCost::kMeasured;
  const MachineModel* model = nullptr;  // costs of `machine` for virtual workers; none: only their work costs
  OperationLogWriter* log = nullptr;
  const Topology* machine = nullptr;    // has the nodes of the places; none: all workers are on one node
  std::vector<Place> places = {};       // the workers' places; none: anywhere
  const ImageOwners* owners = nullptr;  // nodes that own image and transform; none: reads are not counted
  const PageSampler* pages = nullptr;   // sampled at the end of each phase, if given
};

/// The constants of virtual time on the team's machine.
inline TimeCosts costs_of(const Team& team) {
  return team.model != nullptr ? team.model->costs : TimeCosts();
}
/// Returns the virtual seconds of work that `num_working` workers share.
inline double virtual_seconds(const Team& team, const PhaseWork& work, int num_working = 1) {
  const double reference_s = work.seconds(costs_of(team));
  const auto at_work = static_cast<std::size_t>(num_working);
  const double speed = team.model != nullptr ? team.model->speed_of_one_of(at_work) : 1;
  return reference_s / speed / num_working;
}

struct Refinement {
  std::unique_ptr<Mesh> mesh;
  StopReason stop_reason = StopReason::kComplete;
  Counters counters;  // summed over all workers
  std::vector<WorkerReport> workers;
  std::map<std::string, double> phases_s;          // allocate, initial, octree, refine, closing
  std::map<std::string, double> virtual_phases_s;  // some of these phases, if the executor is virtual
  VirtualSpending virtual_spending;
  std::uint64_t num_leaves = 0;
  std::optional<LeafSchedule> schedule;
  PageSamples pages;
  std::optional<PerturbationReport> perturbation;
  std::optional<TopologyReport> topology;  // set if thin layers are kept
  std::unique_ptr<LineEdges> line_edges;   // null: no lines are kept
};

/// The phase that prepares store, pools, workers and threads.
inline constexpr const char* kAllocate = "allocate";

class Construction {
 public:
  using Entries = Coordination::Entries;
  template <class Locks>
  using Workers = std::vector<std::unique_ptr<Worker<Locks>>>;

  /// The store begins with the six cells of a box around `clamp_box`.
  Construction(const Problem& problem, const Box& clamp_box, const Team& team, StopControl& stop);

  const Mesh& mesh() const { return *result_.mesh; }
  /// For use between phases.
  Mesh& mesh() { return *result_.mesh; }
  Pool& pool(WorkerId worker) { return *pools_[worker]; }
  const Problem& problem() const { return problem_; }
  const Team& team() const { return team_; }
  StopControl& stop() { return stop_; }
  int num_workers() const { return team_.coordination.num_workers; }
  /// Every cell of the store.
  Entries all_cells() const;
  /// The edges of the lines, null until keep_lines().
  LineEdges* line_edges() { return result_.line_edges.get(); }
  void keep_lines(std::unique_ptr<LineEdges> edges) { result_.line_edges = std::move(edges); }
  /// The order of the commits in the team's log; null: there is no log.
  CommitOrder* commit_order() { return order_.get(); }

  /// Keeps `bytes` of memory free of the store, instead of the amount kept before. Ends the run if the
  /// store already uses them.
  void reduce_capacity(std::uint64_t bytes);
  /// Makes the first `num_workers` workers of the team, with their pools. The workers keep a reference to the
  /// parameters. The time is charged to `phase`.
  template <class Locks>
  Workers<Locks> make_workers(const Parameters& parameters, int num_workers, const char* phase = kAllocate) {
    Workers<Locks> workers;
    timed(phase, [&] {
      for (WorkerId id = 0; id < static_cast<WorkerId>(num_workers); ++id)
        workers.push_back(std::make_unique<Worker<Locks>>(*result_.mesh, problem_.isosurface, parameters, id,
                                                          *pools_[id], order_.get(), team_.owners));
    });
    return workers;
  }

  /// Charges the phase with the seconds of the action, except those charged to other phases meanwhile. An
  /// action that does work of no virtual worker returns it as PhaseWork, which is charged in virtual time.
  template <class Action>
  void timed(const std::string& phase, Action&& action) {
    const auto start = std::chrono::steady_clock::now();
    const double charged_before_s = charged_s_;
    if constexpr (std::is_same_v<std::invoke_result_t<Action>, PhaseWork>) {
      charge_virtual(phase, action());
    } else {
      action();
    }
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    charge(phase, elapsed.count() - (charged_s_ - charged_before_s));
  }
  /// Calls action(time) with the time of the first `num_workers` workers of the team, and records the virtual
  /// time spent or the processors that threads were bound to. The start of threads is charged to `starting`.
  template <class Action>
  void in_time(const std::string& phase, int num_workers, Action&& action, const char* starting = kAllocate) {
    const auto count = static_cast<std::size_t>(num_workers);
    if (team_.executor == Executor::kVirtual) {
      VirtualTime time(stop_, count, team_.cost, team_.coordination.seed, team_.model, nodes_of_first(count));
      action(time);
      note_virtual_time(phase, time);
    } else {
      RealTime time(stop_, count, places_of_first(count));
      action(time);
      charge(starting, time.start_s());
      for (WorkerId id = 0; id < count; ++id) result_.workers[id].bound_to = time.processor(id).bound_to;
    }
  }
  /// Moves the mesh between operations: cells and vertices at a point go to the NUMA node of
  /// worker_of(point), and stay if that is kNoWorker. All workers of the team move them, in their time.
  /// Returns nothing if the run is over and nothing has moved. If the run ends later, everything has moved.
  template <class Time, class WorkerOf>
  std::optional<Relocation> relocate(Time& time, const WorkerOf& worker_of) {
    const std::vector<NodeIndex> nodes = nodes_of_first(static_cast<std::size_t>(num_workers()));
    std::optional<Relocation> relocation(std::in_place, *result_.mesh, nodes);
    const auto node_of = [&](const Point& p) {
      const WorkerId worker = worker_of(p);
      return worker == kNoWorker ? Relocation::kStay : nodes[worker];
    };
    const AccountedRelocation accounted(*relocation, time);
    time.run([&](WorkerId self) { accounted.look(self, node_of); });
    time.run([&](WorkerId self) { accounted.rename(self, *pools_[self]); });
    if (time.is_over()) return std::nullopt;
    std::vector<char> has_moved(nodes.size(), 0);
    time.run([&](WorkerId self) {
      has_moved[self] = 1;  // a move that has begun ends
      accounted.move(self, *pools_[self]);
    });
    for (WorkerId self = 0; self < has_moved.size(); ++self)  // only starting workers allocates
      if (has_moved[self] == 0) relocation->move(self, *pools_[self]);
    if (line_edges() != nullptr) line_edges()->rename([&](VertexId v) { return relocation->vertex_now(v); });
    if (order_ != nullptr) log(*relocation);
    return relocation;
  }
  /// Accounts for the workers' counts and overhead in a phase that has ended.
  template <class Locks, class Time>
  void account(const Workers<Locks>& workers, const Time& time) {
    for (WorkerId id = 0; id < workers.size(); ++id) {
      workers[id]->flush_log();
      add_counters(*workers[id], time.overhead(*workers[id]));
    }
  }
  /// Called at the end of a phase. No phase is charged for it.
  void sample_pages(const std::string& phase);
  void report_leaves(std::uint64_t num_leaves, std::optional<LeafSchedule> schedule) {
    result_.num_leaves = num_leaves;
    result_.schedule = std::move(schedule);
  }
  void report(const PerturbationReport& perturbation) { result_.perturbation = perturbation; }
  void report(const TopologyReport& topology) { result_.topology = topology; }
  Refinement finish();

 private:
  Place place_of(WorkerId worker) const { return team_.places.empty() ? Place{} : team_.places[worker]; }
  std::vector<Place> places_of_first(std::size_t count) const;
  std::vector<NodeIndex> nodes_of_first(std::size_t count) const;
  template <class Locks>
  void add_counters(const Worker<Locks>& worker, const Overhead& overhead) {
    const WorkerId id = worker.id();
    add(counters_of(worker, overhead, place_of(id), team_.machine), result_.workers[id].counters);
    if (worker.accesses()) accesses_[id].addresses = worker.accesses()->samples();
  }
  void log(const Relocation& relocation);
  void note_virtual_time(const std::string& phase, const VirtualTime& time);
  void charge_virtual(const std::string& phase, const PhaseWork& work) {
    if (team_.executor == Executor::kVirtual) result_.virtual_phases_s[phase] += virtual_seconds(team_, work);
  }
  void charge(const std::string& phase, double seconds) {
    result_.phases_s[phase] += seconds;
    charged_s_ += seconds;
  }

  const Problem& problem_;
  const Team& team_;
  StopControl& stop_;
  std::vector<std::unique_ptr<Pool>> pools_;  // workers keep them from phase to phase
  std::unique_ptr<CommitOrder> order_;        // none: the team has no log
  std::vector<SampledAccesses> accesses_;     // accesses of each worker in the last phase
  Refinement result_;
  double charged_s_ = 0;  // the sum over all phases
};

}  // namespace podm
