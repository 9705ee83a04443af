#include "distributed/rounds.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "algorithms/leaf_size.h"
#include "algorithms/perturb_loop.h"
#include "distributed/completion.h"
#include "distributed/deferred_cells.h"
#include "distributed/learner.h"
#include "distributed/leaves_of_zone.h"
#include "distributed/messages.h"
#include "distributed/predicted_work.h"
#include "distributed/restoring.h"
#include "distributed/seeding.h"
#include "distributed/vertex_exchange.h"
#include "distributed/zone.h"
#include "refine/dihedral_quality.h"
#include "runtime/parallel_collect.h"

namespace podm {

namespace {

// Number of rings of cubes around a zone that are known.
constexpr int kKnownRings = 1;
// Number of rings of cubes around a block whose seeds a rank inserts at once. Most balls of seeds lie there.
constexpr int kSeededRings = 2;
// Number of cubes of the grid around the object. Cubes at the faces of the grid are unbounded, and many cells
// outside the object have balls there. With more cubes around the object these cubes have fewer vertices.
constexpr int kCubesAround = 4;
// Side of a cube over the circumradius bound.
constexpr double kCubeOverRadius = 2;

// A cell that R7 could not change.
struct KeptName {
  CellName cell;
  Unmoved why;
};

// The tasks that ranks do in rounds: R1 to R6, and R7.
enum class Task { kRefine, kPerturb };

// Returns the cube side that suits most cells, unless blocks would then be too coarse.
double cube_side_mm(const Radii& radii, const Box& object, int num_ranks) {
  constexpr double kCubesPerBlock = 512;
  const Vector extent = object.high - object.low;
  const double share_mm3 = extent.x * extent.y * extent.z / num_ranks;
  return std::max(kCubeOverRadius * radii.least,
                  std::min(kCubeOverRadius * radii.most, std::cbrt(share_mm3 / kCubesPerBlock)));
}

CubeGrid grid_around(const Box& object, double side_mm) {
  return CubeGrid(grown(object, kCubesAround * side_mm), side_mm);
}

// Balls that have a point in common and are no larger than a given ball lie within two of its radii. With
// this room around the refined cells, new poor cells that leave the zone would hardly reach the end of it.
// Only round 0 has this room, because the cells that it defers must be refined in later rounds.
constexpr double kRoomInBlocks = 2;

class Rounds {
 public:
  Rounds(const Problem& problem, const Team& team, const DistributedOptions& options, Communication& ranks,
         StopControl& stop)
      : problem_(problem),
        team_(team),
        cut_seed_(options.cut_seed),
        checkpoints_(options.checkpoints),
        ranks_(ranks),
        stop_(stop),
        end_(options.end),
        levels_(two_levels(problem, options.initial_ratio)),
        construction_(problem, levels_.clamp, team, stop),
        grid_(grid_around(problem.object, cube_side_mm(radii_of(problem), problem.object, ranks.size()))),
        learner_(construction_, grid_) {
    if (options.algorithm == Algorithm::kPodm || is_resumed()) return;
    const LeafOptions of_leaves{.initial_ratio = options.initial_ratio, .size_mm = options.leaf_size_mm};
    leaves_.emplace(construction_, levels_, of_leaves, options.algorithm, ranks);
  }

  DistributedRefinement operator()() {
    for (const char* phase : {"initial", "refine"})
      construction_.timed(phase, [] {});  // every rank has these phases
    for (const char* phase : {"octree", "closing"})
      if (leaves_) construction_.timed(phase, [] {});
    if (problem_.dihedral_bounds) construction_.timed(kPerturb, [] {});
    construction_.timed("initial", [&] {
      divide_space();
      is_resumed() ? restore() : seed();
    });
    spending_.end("initial");
    work_in_rounds(Task::kRefine, rounds_);
    if (problem_.dihedral_bounds && !is_over_) perturb();
    const Update last_update =
        complete(construction_.mesh(), *exchange_, block(), kKnownRings, learner_.threads(), ranks_);
    exchange_->check();
    if (perturbation_) report_poor_cells();
    spending_.end("exchange");
    return {.refinement = construction_.finish(),
            .grid = grid_,
            .blocks = *blocks_,
            .cubes = cubes_at_the_end(),
            .rounds = std::move(rounds_),
            .perturbing_rounds = std::move(perturbing_rounds_),
            .seeds = num_seeds_,
            .last_update = last_update,
            .spent = spending_.by_phase()};
  }

 private:
  bool is_resumed() const { return checkpoints_ != nullptr && checkpoints_->is_resumed(); }

  bool is_over_anywhere() { return sum_of_all(stop_.is_over() ? 1 : 0) > 0; }

  // The others may still make their own shares of the limit of cells.
  static bool concerns_all(StopReason reason) {
    return reason != StopReason::kComplete && reason != StopReason::kElementLimit;
  }

  void divide_space() {
    if (cut_seed_ != 0) {
      blocks_.emplace(grid_, cut_seed_, ranks_.size());
    } else {
      blocks_.emplace(grid_, predicted_work(problem_, grid_, learner_.threads(), ranks_), ranks_);
    }
  }

  CubesOfRank cubes_at_the_end() const {
    const Box& box = grid_.box();
    return {.grid = {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z},
            .side_mm = grid_.side_mm(),
            .block = block().runs(),
            .known = exchange_->known().runs()};
  }

  CubeSet block() const {
    CubeSet block(grid_);
    block.insert(blocks_->range_of(ranks_.rank()));
    return block;
  }

  // Returns how much coarser seeds have to be, a power of two, for their cells to be at most half of the
  // limit. A run that is over gets the fewest.
  double seeds_within_limit() {
    constexpr double kCellsPerSeed = 7, kMost = 1024;
    double coarser = is_over_anywhere() ? kMost : 1;
    for (; stop_.max_elements() > 0 && coarser < kMost; coarser *= 2) {
      const LatticeSeeds seeds(problem_, box_of_seeds(levels_.clamp), learner_.threads(), coarser);
      const std::uint64_t num_seeds = sum_of_all(seeds.in(block()).size());
      if (2 * kCellsPerSeed * static_cast<double>(num_seeds) <= static_cast<double>(stop_.max_elements()))
        break;
    }
    return coarser;
  }

  // Inserts seeds until the cells with a vertex in the block are cells of the triangulation of all seeds.
  void seed() {
    const LatticeSeeds seeds(problem_, box_of_seeds(levels_.clamp), learner_.threads(), seeds_within_limit());
    Seeding seeding(seeds, learner_, block());
    complete(construction_.mesh(), seeding, block(), kSeededRings, learner_.threads(), ranks_);
    num_seeds_ = seeding.num_inserted();
    exchange_.emplace(ranks_, learner_, grid_, *blocks_, seeding.known());
    exchange_->check();
  }

  // Inserts vertices of a checkpoint, and then those that the cells with a vertex in the block need.
  void restore() {
    const std::vector<LearntVertex> vertices = vertices_to_restore(*checkpoints_, *blocks_, grid_, ranks_);
    learner_.learn(vertices, kReceivedInsertion, nullptr);
    exchange_.emplace(ranks_, learner_, grid_, *blocks_, block());
    const Update more =
        complete(construction_.mesh(), *exchange_, block(), kSeededRings, learner_.threads(), ranks_);
    num_seeds_ = vertices.size() + more.inserted;
    exchange_->check();
  }

  // Writes a checkpoint if one is due, and before work that would be lost: the end of a run that is over, and
  // R7.
  void save() {
    const bool is_last = is_over_ || (rounds_.back().deferred == 0 && problem_.dihedral_bounds);
    if (checkpoints_ == nullptr || !(is_last || checkpoints_->is_due())) return;
    checkpoints_->write(shared_vertices(construction_.mesh(), exchange_->written(), learner_.threads()),
                        rounds_.size());
  }

  // Returns true if this rank owns the cell. A cell belongs to the rank whose block has its least vertex. The
  // corners of the virtual box count only in cells that have no other vertices, because no rank is sure to
  // have all cells around such a corner.
  bool is_own(const Cell& cell, const CubeRange& block) const {
    const Mesh& mesh = construction_.mesh();
    const auto is_corner = [&](VertexId v) { return mesh.vertex(v).kind == VertexKind::kBox; };
    const VertexId least =
        *std::min_element(cell.vertices.begin(), cell.vertices.end(), [&](VertexId v, VertexId w) {
          if (is_corner(v) != is_corner(w)) return is_corner(w);
          return lexicographically_less(mesh.point(v), mesh.point(w));
        });
    return block.has(grid_.place_of(mesh.point(least)));
  }

  // Works until no cell waits, or the run is over.
  void work_in_rounds(Task task, std::vector<RoundReport>& rounds) {
    ZonesInRounds zones(grid_, *blocks_, construction_.mesh().extent(), learner_.threads(), ranks_);
    std::vector<CellName> here;  // deferred cells that this rank's zone has
    do {
      const auto round = static_cast<int>(rounds.size());
      const bool is_first = round == 0, knows_seeds = is_first && task == Task::kRefine;
      RoundReport report;
      const CubeSet own = zones.of_this_round().of(ranks_.rank());
      report.cubes = own.cubes().size();
      const double start_s = ranks_.report().computing_s;
      std::vector<CellName> left;
      if (!knows_seeds) {
        // A rank without cells learns its zone, too: it is the zone's writer from now on.
        report.update = exchange_->update(zones.wanted(own.grown(kKnownRings), here));
        exchange_->check();
      }
      const Zone zone(own, exchange_->known(), kKnownRings, knows_seeds ? kRoomInBlocks : 0);
      Construction::Entries entries = is_first ? first_entries(task) : find(here, zone, left);
      if (knows_seeds) count_cells_of_all(entries.size());
      if (task == Task::kRefine) drop_sound(entries, zone);
      share_limit(entries.size());
      report.entries = entries.size();
      report.update_s = ranks_.report().computing_s - start_s;
      spending_.end("exchange");
      if (team_.log != nullptr) team_.log->begin_step();
      if (knows_seeds && leaves_) entries = refine_leaves(zone, entries, report);
      add_names(work_in(task, zone, entries, report), left);
      if (end_ != nullptr && concerns_all(stop_.reason())) end_->announce();
      report.refine_s = ranks_.report().computing_s - start_s - report.update_s;
      spending_.end(task == Task::kPerturb ? kPerturb : is_first ? "refine" : "later");
      exchange_->note_writers(zones.of_this_round(), own);
      report.deferred = sum_of_all(left.size());
      is_over_ = is_over_anywhere();
      const bool is_last = report.deferred == 0 || is_over_;
      here = is_last ? std::vector<CellName>() : zones.plan_next(round, left, exchange_->writers());
      rounds.push_back(report);
      if (task == Task::kRefine) save();
    } while (rounds.back().deferred > 0 && !is_over_);
  }

  void add_names(const std::vector<CellId>& cells, std::vector<CellName>& names) const {
    const std::size_t before = names.size();
    names.resize(before + cells.size());
    parallel_for_each(cells.size(), learner_.threads(),
                      [&](std::size_t i) { names[before + i] = name_of(construction_.mesh(), cells[i]); });
  }

  // A poor cell whose ball reaches beyond the known cubes may be absent here. R7 does not try it.
  Construction::Entries first_entries(Task task) {
    if (task == Task::kRefine) return own_cells();
    Construction::Entries poor = own_poor_cells();
    perturbation_->before = count(poor);
    return poor;
  }

  void count_cells_of_all(std::size_t own) {
    cells_of_all_ = static_cast<std::int64_t>(sum_of_all(own));
    cells_reported_ = stop_.num_cells();
  }

  // Divides the rest of the cell limit among the ranks by the numbers of cells that they begin with.
  void share_limit(std::size_t num_entries) {
    const std::int64_t more = stop_.num_cells() - cells_reported_;
    std::array<std::uint64_t, 2> sums{static_cast<std::uint64_t>(more), num_entries};
    ranks_.sum(sums);  // modulo 2^64, so negative numbers add up as well
    cells_reported_ += more;
    cells_of_all_ += static_cast<std::int64_t>(sums[0]);
    stop_.share_limit(cells_of_all_, static_cast<double>(num_entries) /
                                         static_cast<double>(std::max<std::uint64_t>(1, sums[1])));
  }

  Construction::Entries own_cells() const {
    const Mesh& mesh = construction_.mesh();
    const CubeRange block = blocks_->range_of(ranks_.rank());
    return parallel_collect<Construction::Entries::value_type>(
        mesh.cell_bound(), learner_.threads(), [&](std::size_t begin, std::size_t end, auto& own) {
          for (auto c = static_cast<CellId>(begin); c < end; ++c)
            if (mesh.cell(c).is_alive() && is_own(mesh.cell(c), block)) own.push_back({c, mesh.stamp(c)});
        });
  }

  // Returns this rank's cells with dihedral angles out of bounds.
  Construction::Entries own_poor_cells() {
    Mesh& mesh = construction_.mesh();
    const Rules rules(mesh, problem_.isosurface, levels_.final);
    Construction::Entries own = own_cells();
    return parallel_collect<Construction::Entries::value_type>(
        own.size(), learner_.threads(), [&](std::size_t begin, std::size_t end, auto& poor) {
          for (std::size_t i = begin; i < end; ++i)
            if (is_poor(mesh, rules, own[i].cell, *problem_.dihedral_bounds)) poor.push_back(own[i]);
        });
  }

  PerturbationReport::Cells count(const Construction::Entries& poor) const {
    PerturbationReport::Cells cells;
    for (const auto& entry : poor)
      ++(has_free_vertex(construction_.mesh(), entry.cell) ? cells.with_free_vertex : cells.without);
    return cells;
  }

  // Applies R7, after R1 to R6 on all ranks.
  void perturb() {
    perturbation_.emplace();
    perturbation_->min_dihedral_deg = problem_.dihedral_bounds->least_deg();
    perturbation_->max_dihedral_deg = problem_.dihedral_bounds->largest_deg();
    work_in_rounds(Task::kPerturb, perturbing_rounds_);
  }

  // Counts this rank's cells that are still poor. The rank that tried a cell last sends the reason to the
  // cell's rank.
  void report_poor_cells() {
    PerturbationReport& report = *perturbation_;
    std::vector<std::vector<KeptName>> kept(static_cast<std::size_t>(ranks_.size()));
    for (const KeptName& name : kept_) {
      const int rank = blocks_->of(grid_.place_of(name.cell.vertices[0]));
      kept.at(static_cast<std::size_t>(rank)).push_back(name);
    }
    const Construction::Entries poor = own_poor_cells();
    report.after = count(poor);
    std::set<CellId> unexplained;
    for (const auto& entry : poor) unexplained.insert(entry.cell);
    for (const KeptName& name : exchanged(kept, ranks_)) {
      const auto cell = learner_.find_cell(name.cell.vertices);
      if (cell && unexplained.erase(*cell) > 0) ++report.unmoved[static_cast<std::size_t>(name.why)];
    }
    report.not_reached = unexplained.size();
    construction_.report(report);
  }

  // Returns the cells with these names in the zone. A cell that is not in the mesh has died if all vertices
  // are known that could be in its ball. Otherwise the cell is `left` for another round.
  Construction::Entries find(const std::vector<CellName>& names, const Zone& zone,
                             std::vector<CellName>& left) {
    const Mesh& mesh = construction_.mesh();
    const std::vector<std::size_t> order = along_curve(names, grid_, learner_.threads());
    const auto cells = learner_.find_cells(
        names.size(), [&](std::size_t i) -> const auto& { return names[order[i]].vertices; });
    const auto is_left = [&](std::size_t i) {
      if (cells[i]) return false;
      const Ball ball = circumscribed_ball(names[order[i]], mesh.extent());
      return !zone.is_ball_known(ball.center, ball.radius);
    };
    Construction::Entries entries;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (cells[i]) entries.push_back({*cells[i], mesh.stamp(*cells[i])});
      if (is_left(i)) left.push_back(names[order[i]]);
    }
    return entries;
  }

  // No rank changes its mesh yet. The function can therefore read cells that lie across zones, which no
  // worker can read later. Most of the large cells far from the object are such cells. The workers examine
  // all other cells later.
  void drop_sound(Construction::Entries& entries, const Zone& zone) {
    Mesh& mesh = construction_.mesh();
    const Rules rules(mesh, problem_.isosurface, levels_.final);
    const auto is_known = [&](CellId c) {
      const Cell& cell = mesh.cell(c);
      return zone.is_ball_known(cell) &&
             std::all_of(cell.mirrors.begin(), cell.mirrors.end(), [&](FacetId mirror) {
               return mirror == kNoFacet || zone.is_ball_known(mesh.cell(cell_of(mirror)));
             });
    };
    const auto is_dropped = [&](const auto& entry) {
      if (zone.may_read(mesh, mesh.cell(entry.cell)) || !is_known(entry.cell) || !rules.is_sound(entry.cell))
        return false;
      mesh.set_relies_on_others(entry.cell, true);  // it may
      return true;
    };
    entries = parallel_collect<Construction::Entries::value_type>(
        entries.size(), learner_.threads(), [&](std::size_t begin, std::size_t end, auto& kept) {
          for (std::size_t i = begin; i < end; ++i)
            if (!is_dropped(entries[i])) kept.push_back(entries[i]);
        });
  }

  // Returns the cells that are left for PODM.
  Construction::Entries refine_leaves(const Zone& zone, const Construction::Entries& entries,
                                      RoundReport& report) {
    LeavesOfZone::Refined refined = (*leaves_)(zone, entries);
    report.insertions += report.in_leaves = refined.insertions;
    return std::move(refined.left);
  }

  std::vector<CellId> work_in(Task task, const Zone& zone, const Construction::Entries& entries,
                              RoundReport& report) {
    if (construction_.num_workers() > 1) return work_with<VertexLocks>(task, zone, entries, report);
    return work_with<NoLocks>(task, zone, entries, report);
  }

  // Gives each worker an equal share. Most cells that follow each other in the list are near each other:
  // names are looked up along a curve, and most of the seeds are inserted along it.
  template <class Locks>
  static void share_out(const Construction::Entries& entries, const Construction::Workers<Locks>& workers) {
    const auto at = [&](std::size_t worker) {
      return entries.begin() + static_cast<std::ptrdiff_t>(entries.size() * worker / workers.size());
    };
    for (std::size_t i = 0; i < workers.size(); ++i)
      workers[i]->give(Construction::Entries(at(i), at(i + 1)));
  }

  // Returns the cells that need vertices outside the zone.
  template <class Inner>
  std::vector<CellId> work_with(Task task, const Zone& zone, const Construction::Entries& entries,
                                RoundReport& report) {
    if (entries.empty() || stop_.is_over()) return {};
    const char* const phase = task == Task::kPerturb ? kPerturb : leaves_ ? "closing" : "refine";
    std::vector<CellId> deferred;
    construction_.timed(phase, [&] {
      const auto workers =
          construction_.make_workers<ZoneLocks<Inner>>(levels_.final, construction_.num_workers());
      for (const auto& worker : workers) worker->locks().confine(zone);
      if (task == Task::kPerturb) begin_perturbation(construction_, workers);
      construction_.in_time(phase, construction_.num_workers(), [&](auto& time) {
        share_out(entries, workers);
        if (task == Task::kPerturb) {
          try {
            perturb_listed(construction_, workers, time);
          } catch (const std::bad_alloc&) {  // for the lists between efforts
            stop_.end(StopReason::kMemoryLimit);
          }
          construction_.account(workers, time);
        } else {
          refine(construction_, workers, coordination_of_first(team_, construction_.num_workers()), {}, time);
        }
      });
      for (const auto& worker : workers) {
        report.insertions += changes_of(worker->counters());
        take_deferred(*worker, deferred);
        take_kept(*worker);
      }
    });
    return deferred;
  }

  static std::uint64_t changes_of(const Counters& counters) {
    std::uint64_t changes = counters.moves;
    for (const std::uint64_t count : counters.insertions_by_rule) changes += count;
    return changes;
  }

  // A deferred cell may rely on vertices of other cells. No rule has examined it.
  template <class Locks>
  void take_deferred(Worker<Locks>& worker, std::vector<CellId>& deferred) {
    Mesh& mesh = construction_.mesh();
    for (const auto& entry : worker.take_deferred()) {
      if (mesh.stamp(entry.cell) != entry.stamp) continue;
      mesh.set_relies_on_others(entry.cell, true);
      deferred.push_back(entry.cell);
    }
  }

  template <class Locks>
  void take_kept(Worker<Locks>& worker) {
    const Mesh& mesh = construction_.mesh();
    for (const auto& [entry, why] : worker.take_kept())
      if (mesh.stamp(entry.cell) == entry.stamp) kept_.push_back({name_of(mesh, entry.cell), why});
  }

  std::uint64_t sum_of_all(std::uint64_t here) {
    std::array<std::uint64_t, 1> sum{here};
    ranks_.sum(sum);
    return sum[0];
  }

  const Problem& problem_;
  const Team& team_;
  const std::uint64_t cut_seed_;
  Checkpoints* const checkpoints_;  // null: none
  Communication& ranks_;
  StopControl& stop_;
  EndOnAllRanks* const end_;  // null: a rank hears of others' ends between rounds
  Spending spending_{ranks_};
  const TwoLevels levels_;
  Construction construction_;
  const CubeGrid grid_;
  Learner learner_;
  std::optional<Blocks> blocks_;
  std::optional<VertexExchange> exchange_;
  std::optional<LeavesOfZone> leaves_;  // unset: PODM alone
  std::vector<RoundReport> rounds_, perturbing_rounds_;
  std::optional<PerturbationReport> perturbation_;  // of R7, if it is applied
  std::vector<KeptName> kept_;                      // cells that R7 could not change on this rank
  std::uint64_t num_seeds_ = 0;
  std::int64_t cells_of_all_ = 0;    // cells of the whole mesh before the round
  std::int64_t cells_reported_ = 0;  // number of this rank's added cells that the other ranks know
  bool is_over_ = false;             // the same on all ranks
};

}  // namespace

DistributedRefinement podm_distributed(const Problem& problem, const Team& team,
                                       const DistributedOptions& options, Communication& ranks,
                                       StopControl& stop) {
  return Rounds(problem, team, options, ranks, stop)();
}

}  // namespace podm
