#include "optimize/optimize_mesh.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <new>

#include "optimize/interface_hash.h"
#include "optimize/obstacles.h"
#include "podm/errors.h"
#include "refine/dihedral_quality.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

using Means = OptimizationMeans;

// Cells that a peel leaves beyond the bounds are searched once more, with more steps.
constexpr std::array kPasses{
    OptimizerPass{Means::kFlips, false, 0},          OptimizerPass{Means::kMoves, false, 0},
    OptimizerPass{Means::kSearches, false, 400},     OptimizerPass{Means::kAddedVertices, false, 400},
    OptimizerPass{Means::kPeels, true, 400},         OptimizerPass{Means::kSearches, true, 4000},
    OptimizerPass{Means::kAddedVertices, true, 4000}};

template <class Locks>
class Optimization {
 public:
  using Entry = typename Optimizer<Locks>::Entry;
  using Entries = std::vector<Entry>;

  Optimization(Mesh& mesh, const OptimizerParameters& parameters, const Team& team)
      : mesh_(mesh), parameters_(parameters) {
    const auto num_workers = static_cast<std::size_t>(team.coordination.num_workers);
    for (WorkerId id = 0; id < num_workers; ++id) {
      const int node = team.places.empty() ? 0 : team.places[id].node;
      pools_.push_back(std::make_unique<Pool>(mesh, static_cast<NodeIndex>(node), num_workers));
      workers_.push_back(std::make_unique<Optimizer<Locks>>(mesh, parameters, id, *pools_[id]));
    }
    for (const auto& [means, name] : Names<Means>::kAll) report_.successes[means] = 0;
    for (const auto& [obstacle, name] : Names<OptimizationObstacle>::kAll) report_.obstacles[obstacle] = 0;
  }

  template <class Time>
  OptimizationReport operator()(Time& time, StopControl& stop) {
    try {
      make_all(time);
    } catch (const std::bad_alloc&) {  // for lists between passes
      stop.end(StopReason::kMemoryLimit);
      report_all_cells();
    }
    report_successes();
    return std::move(report_);  // a copy would allocate memory
  }
  /// The fraction of the work that is done, while workers run. It falls a little when cells are tried again.
  double fraction() const {
    const auto taken = static_cast<double>(std::min(next_.load(), num_cells_.load()));
    const double of_pass = num_cells_ == 0 ? 0 : taken / static_cast<double>(num_cells_);
    return (num_passes_ + of_pass) / kPasses.size();
  }

 private:
  template <class Time>
  void make_all(Time& time) {
    std::uint64_t interfaces = 0;
    Entries bad = find_bad_cells(interfaces);
    report_.beyond_aim_before = bad.size();
    report_.beyond_bounds_before = num_beyond_bounds(bad);
    for (const OptimizerPass& pass : kPasses) {
      if (time.is_over() || bad.empty()) break;
      bad = make(pass, std::move(bad), time);
      ++num_passes_;
    }
    for (const auto& worker : workers_) interfaces += worker->interface_change();
    if (interfaces != hash_of_interfaces())
      throw InternalError("optimisation changed facets between labels, other than by peels");
    report_cells(bad);
  }

  // Cells are found in chunks, and workers take them in shares, which are small for passes with slow
  // attempts.
  static constexpr std::size_t kChunk = 1 << 12, kMostShared = 64;

  // Calls visit(c) for each cell except those of the background, and returns the hash of interfaces.
  template <class Visit>
  std::uint64_t hash_and_visit(const Visit& visit) const {
    const CellId bound = mesh_.cell_bound();
    std::atomic<std::uint64_t> hash = 0;
    parallel_for_ranges(bound, kChunk, workers_.size(), [&](std::size_t begin, std::size_t end, std::size_t) {
      std::uint64_t sum = 0;
      for (auto c = static_cast<CellId>(begin); c < end; ++c) {
        if (!mesh_.cell(c).is_alive() || mesh_.label(c) == kBackground) continue;
        sum += share_of_interface_hash(mesh_, c, mesh_.label(c));
        visit(c);
      }
      hash.fetch_add(sum, std::memory_order_relaxed);
    });
    return hash;
  }
  std::uint64_t hash_of_interfaces() const {
    return hash_and_visit([](CellId) {});
  }

  Entries find_bad_cells(std::uint64_t& hash_of_interfaces) const {
    std::vector<std::uint8_t> is_bad(mesh_.cell_bound());
    hash_of_interfaces = hash_and_visit([&](CellId c) {
      if (c + kLookahead < is_bad.size()) mesh_.prefetch_vertices(c + kLookahead);
      is_bad[c] = is_beyond_aim(c);
    });
    Entries bad;
    for (CellId c = 0; c < is_bad.size(); ++c)
      if (is_bad[c] != 0) bad.push_back({c, mesh_.stamp(c)});
    return bad;
  }
  static constexpr CellId kLookahead = 8;

  // Makes a pass over these cells and returns the cells that are still bad. Cells that met locks of other
  // workers are tried again by half as many workers, and finally by one, which meets no locks.
  template <class Time>
  Entries make(const OptimizerPass& pass, Entries cells, Time& time) {
    Entries left;
    for (std::size_t num_working = workers_.size(); !cells.empty();
         num_working = std::max<std::size_t>(1, num_working / 2)) {
      next_ = 0;
      num_cells_ = cells.size();
      time.run([&](WorkerId self) {
        if (self < num_working) work(*workers_[self], pass, cells, time);
      });
      Entries conflicts;
      left.insert(left.end(),
                  cells.begin() + static_cast<std::ptrdiff_t>(std::min(next_.load(), cells.size())),
                  cells.end());
      for (const auto& worker : workers_) {
        append(worker->take_conflicts(), time.is_over() ? left : conflicts);
        append(worker->take_given_up(), left);
        append(worker->take_listed(), left);
      }
      cells = std::move(conflicts);
    }
    return left;
  }

  template <class Time>
  void work(Optimizer<Locks>& worker, const OptimizerPass& pass, const Entries& cells, Time& time) {
    worker.begin(pass);
    const std::size_t share =
        pass.max_search_steps > 0
            ? 1
            : std::clamp<std::size_t>(cells.size() / (8 * workers_.size()), 1, kMostShared);
    while (!time.is_over()) {
      if (!worker.has_work()) {
        const std::size_t begin = next_.fetch_add(share, std::memory_order_relaxed);
        if (begin >= cells.size()) break;
        for (std::size_t i = std::min(cells.size(), begin + share); i-- > begin;) worker.give(cells[i]);
      }
      time.attempt(worker);
    }
    time.check_limits(worker);
  }

  static void append(Entries&& from, Entries& to) { to.insert(to.end(), from.begin(), from.end()); }

  bool is_beyond_aim(CellId c) const { return dihedral_quality(mesh_, c, parameters_.aim.bounds()) < 1; }
  bool is_beyond_bounds(CellId c) const { return dihedral_quality(mesh_, c, parameters_.bound) < 1; }
  std::uint64_t num_beyond_bounds(const Entries& cells) const {
    return static_cast<std::uint64_t>(
        std::count_if(cells.begin(), cells.end(), [&](const Entry& e) { return is_beyond_bounds(e.cell); }));
  }

  // Every living bad cell is in `left`.
  void report_cells(const Entries& left) {
    for (const Entry& entry : left)
      if (mesh_.stamp(entry.cell) == entry.stamp) report_bad_cell(entry.cell);
  }
  // Used when the list of bad cells is lost.
  void report_all_cells() {
    for (CellId c = 0; c < mesh_.cell_bound(); ++c)
      if (mesh_.cell(c).is_alive() && mesh_.label(c) != kBackground && is_beyond_aim(c)) report_bad_cell(c);
  }
  void report_bad_cell(CellId c) {
    ++report_.beyond_aim;
    if (!is_beyond_bounds(c)) return;
    ++report_.beyond_bounds;
    ++report_.obstacles[obstacle_of(mesh_, c, parameters_.bound)];
  }
  void report_successes() {
    for (auto& [means, count] : report_.successes)
      for (const auto& worker : workers_) count += worker->successes()[static_cast<std::size_t>(means)];
  }

  Mesh& mesh_;
  const OptimizerParameters& parameters_;
  std::vector<std::unique_ptr<Pool>> pools_;
  std::vector<std::unique_ptr<Optimizer<Locks>>> workers_;
  OptimizationReport report_;
  int num_passes_ = 0;                                 // completed
  std::atomic<std::size_t> next_ = 0, num_cells_ = 0;  // of the current pass: the next cell to take, and the
                                                       // number of cells
};

using Observe = std::function<void(double)>;

template <class Locks, class Time>
OptimizationReport optimize_in(Time& time, Mesh& mesh, const OptimizerParameters& parameters,
                               const Team& team, StopControl& stop, const Observe& observe) {
  Optimization<Locks> optimization(mesh, parameters, team);
  double most = 0;
  stop.observe_by([&](std::uint64_t) { observe(most = std::max(most, optimization.fraction())); });
  OptimizationReport report = optimization(time, stop);
  stop.observe_by([](std::uint64_t) {});  // the object that it reads is destroyed
  return report;
}

template <class Time>
OptimizationReport optimize_in(Time& time, Mesh& mesh, const OptimizerParameters& parameters,
                               const Team& team, StopControl& stop, const Observe& observe) {
  if (team.coordination.num_workers == 1)
    return optimize_in<NoLocks>(time, mesh, parameters, team, stop, observe);
  return optimize_in<VertexLocks>(time, mesh, parameters, team, stop, observe);
}

}  // namespace

DihedralBounds aim_over(const DihedralBounds& bounds) {
  return {1.5 * bounds.least_deg(), 180 - 4.0 / 3 * (180 - bounds.largest_deg())};
}

OptimizationReport optimize_mesh(Mesh& mesh, const OptimizerParameters& parameters, const Team& team,
                                 StopControl& stop, const Observe& observe) {
  const auto num_workers = static_cast<std::size_t>(team.coordination.num_workers);
  OptimizationReport report;
  if (team.executor == Executor::kVirtual) {
    VirtualTime time(stop, num_workers, team.cost, team.coordination.seed);
    report = optimize_in(time, mesh, parameters, team, stop, observe);
  } else {
    RealTime time(stop, num_workers, team.places);
    report = optimize_in(time, mesh, parameters, team, stop, observe);
  }
  report.least_dihedral_deg = parameters.bound.least_deg();
  report.largest_dihedral_deg = parameters.bound.largest_deg();
  report.least_aim_deg = parameters.aim.bounds().least_deg();
  report.largest_aim_deg = parameters.aim.bounds().largest_deg();
  return report;
}

}  // namespace podm
