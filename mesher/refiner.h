// What the algorithms are made of: a store, the workers' pools, and phases that refine it one after another.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "octree/octree.h"
#include "page_sampler.h"
#include "podm/operation_log.h"
#include "refine/coordination.h"
#include "refine/executor.h"
#include "refine/leaf_refinement.h"
#include "refine/rules.h"
#include "refine/worker.h"
#include "runtime/placement.h"

namespace podm {

struct Problem {
  const Isosurface& isosurface;
  Box object;  // bounds of the foreground
  double delta_mm = 0;
  SizeField sizes;
  std::size_t cell_capacity = 0;  // the most cells the store may hold
  // What store, workers and leaves may take together. The capacity takes workers into account, not leaves.
  std::uint64_t memory_bytes = std::numeric_limits<std::uint64_t>::max();
  std::size_t most_numbered_cells = kMostStoredCells;  // a capacity as large is none of memory
};

/// Who refines.
struct Crew {
  Executor executor = Executor::kThreads;
  CoordinationOptions coordination;
  VirtualCost cost = VirtualCost::kMeasured;
  OperationLogWriter* log = nullptr;
  const Topology* machine = nullptr;    // whose nodes the places name; none: all are on one
  std::vector<Place> places = {};       // of the workers; none: anywhere
  const ImageOwners* owners = nullptr;  // of the machine's nodes, image and transform; none: not counted
  const PageSampler* pages = nullptr;   // asked at the end of each phase, if any
  bool locks_alone = false;             // a single worker locks too: to measure what locks cost
};

struct Refinement {
  std::unique_ptr<Mesh> mesh;
  StopReason stop_reason = StopReason::kComplete;
  Counters counters;  // of all workers
  std::vector<WorkerReport> workers;
  std::map<std::string, double> phases_s;          // allocate, initial, octree, refine, closing
  std::map<std::string, double> virtual_phases_s;  // of Executor::kVirtual; some of these phases
  std::uint64_t num_leaves = 0;
  std::optional<LeafSchedule> schedule;
  PageSamples pages;
};

class Refiner {
 public:
  using Entries = CellSource::Entries;

  /// The store begins as the six cells of a box around `clamp_box`.
  Refiner(const Problem& problem, const Box& clamp_box, const Crew& crew, Watch& watch);

  /// Every cell of the store.
  Entries all_cells() const;
  /// PODM: the first `num_workers` of the crew insert and remove points anywhere at once, with locks unless
  /// there is only one. Its seconds are those of `phase`.
  void refine_anywhere(const std::string& phase, const Parameters& parameters, const Entries& cells,
                       int num_workers);
  /// PDR.PODM: `num_nodes` computing nodes refine leaf after leaf. Locks: LeafLocks<NoLocks> for nodes of one
  /// worker. Returns what no leaf could refine.
  template <class Locks>
  Entries refine_leaves(const std::string& phase, const Parameters& parameters, const Octree& octree,
                        int num_nodes, bool with_schedule);

  /// Keeps so much memory free of the store, instead of what was withheld before. Where the store has it
  /// already the run is over.
  void withhold(std::uint64_t bytes);

  /// Charges the phase with the action's seconds, but for those that were charged to others meanwhile.
  template <class Action>
  void timed(const std::string& phase, Action&& action) {
    const auto start = std::chrono::steady_clock::now();
    const double charged_before_s = charged_s_;
    action();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    charge(phase, elapsed.count() - (charged_s_ - charged_before_s));
  }
  const Mesh& mesh() const { return *result_.mesh; }
  bool is_over() const { return watch_.reason() != StopReason::kComplete; }
  int num_workers() const { return crew_.coordination.num_workers; }
  Refinement finish();

 private:
  template <class Locks>
  using Workers = std::vector<std::unique_ptr<Worker<Locks>>>;

  template <class Locks>
  Workers<Locks> make_workers(const Parameters& parameters, int num_workers);
  template <class Locks>
  Entries refine_leaves_in_virtual_time(const std::string& phase, const Parameters& parameters,
                                        const Octree& octree, int num_nodes, bool with_schedule);
  template <class Locks>
  void account(const Worker<Locks>& worker, WorkerId id, const Overhead& overhead);
  template <class Locks>
  void run_on_threads(const CoordinationOptions& options, std::vector<ComputingNode<Locks>>& nodes);
  template <class Locks, class RunNodes>
  Entries run_leaves(const Parameters& parameters, const Octree& octree, int num_nodes, bool with_schedule,
                     std::function<double()> clock, const RunNodes& run_nodes);
  Place place_of(WorkerId worker) const { return crew_.places.empty() ? Place{} : crew_.places[worker]; }
  void sample_pages(const std::string& phase);  // at its end; in none of its seconds
  CoordinationOptions coordination(int num_workers) const;
  CoordinationOptions node_coordination(int num_nodes) const;
  void charge(const std::string& phase, double seconds) {
    result_.phases_s[phase] += seconds;
    charged_s_ += seconds;
  }

  const Problem& problem_;
  const Crew& crew_;
  Watch& watch_;
  std::vector<std::unique_ptr<Pool>> pools_;  // of the workers, from phase to phase
  std::vector<SampledAccesses> accesses_;     // by worker, of the last phase
  Refinement result_;
  double charged_s_ = 0;  // to all phases
};

}  // namespace podm
