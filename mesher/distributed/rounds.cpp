#include "distributed/rounds.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "algorithms/leaf_size.h"
#include "algorithms/perturb_loop.h"
#include "distributed/completion.h"
#include "distributed/learner.h"
#include "distributed/leaves_of_zone.h"
#include "distributed/messages.h"
#include "distributed/predicted_work.h"
#include "distributed/seeding.h"
#include "distributed/vertex_exchange.h"
#include "distributed/zone.h"
#include "distributed/zones_of_round.h"
#include "refine/dihedral_quality.h"
#include "runtime/parallel_collect.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

// Number of rings of cubes around a zone that are known.
constexpr int kKnownRings = 1;
// Number of rings of cubes around a block whose seeds a rank inserts at once. Most balls of seeds lie there.
constexpr int kSeededRings = 2;
// Number of cubes of the grid around the object. Cubes at the faces of the grid are unbounded, and many cells
// outside the object have balls there. With more cubes around the object these cubes have fewer vertices.
constexpr int kCubesAround = 4;
// A deferred cell also requests vertices within this many of its circumradii. A larger factor costs more than
// it saves.
constexpr double kKnownOverRadius = 1;
// Side of a cube over the circumradius bound.
constexpr double kCubeOverRadius = 2;

// A name of a cell that is the same on all ranks.
struct CellName {
  std::array<Point, 4> vertices;
};

CellName name_of(const Mesh& mesh, CellId c) {
  CellName name;
  for (std::size_t i = 0; i < 4; ++i) name.vertices[i] = mesh.point(mesh.cell(c).vertices[i]);
  std::sort(name.vertices.begin(), name.vertices.end(), lexicographically_less);
  return name;
}

struct Ball {
  Point center;
  double radius_mm;
};

// The deferred cells with their centers in one cube.
struct Waiting {
  CubeId cube;
  std::uint32_t cells;
  Ball largest;
};

// A cell that R7 could not change.
struct KeptName {
  CellName cell;
  Unmoved why;
};

// The tasks that ranks do in rounds: R1 to R6, and R7.
enum class Task { kRefine, kPerturb };

Ball ball_of(const CellName& name, double extent) {
  const auto& v = name.vertices;
  const Point center = circumsphere(v[0], v[1], v[2], v[3], extent).center;
  return {center, distance(center, v[0])};
}

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

  bool is_over_anywhere() {
    std::array<std::uint64_t, 1> num_over{stop_.is_over() ? 1u : 0u};
    ranks_.sum(num_over);
    return num_over[0] > 0;
  }

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
  // limit.
  // A run that is over gets the fewest.
  double seeds_within_limit() {
    constexpr double kCellsPerSeed = 7, kMost = 1024;
    double coarser = is_over_anywhere() ? kMost : 1;
    for (; stop_.max_elements() > 0 && coarser < kMost; coarser *= 2) {
      const LatticeSeeds seeds(problem_, box_of_seeds(levels_.clamp), learner_.threads(), coarser);
      std::array<std::uint64_t, 1> num_seeds{seeds.in(block()).size()};
      ranks_.sum(num_seeds);
      if (2 * kCellsPerSeed * static_cast<double>(num_seeds[0]) <= static_cast<double>(stop_.max_elements()))
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

  // Inserts the vertices of a checkpoint in the block, the fewer elsewhere the farther away, and then those
  // that the cells with a vertex in the block need. The ranks of the checkpoint may have had other blocks.
  void restore() {
    std::vector<std::vector<LearntVertex>> of_rank(static_cast<std::size_t>(ranks_.size()));
    for (const LearntVertex& vertex : checkpoints_->read())
      of_rank.at(static_cast<std::size_t>(blocks_->of(grid_.place_of(vertex.point)))).push_back(vertex);
    std::vector<LearntVertex> own = exchanged(of_rank);
    const std::vector<LearntVertex> some = sparse_around(blocks_->range_of(ranks_.rank()), grid_, own);
    for (int rank = 0; rank < ranks_.size(); ++rank)
      of_rank[static_cast<std::size_t>(rank)] = rank == ranks_.rank()
                                                    ? std::vector<LearntVertex>()
                                                    : sparse_around(blocks_->range_of(rank), grid_, some);
    const std::vector<LearntVertex> elsewhere = exchanged(of_rank);
    of_rank = {};
    own.insert(own.end(), elsewhere.begin(), elsewhere.end());
    learner_.learn(own, kReceivedInsertion, nullptr);
    exchange_.emplace(ranks_, learner_, grid_, *blocks_, block());
    const Update more =
        complete(construction_.mesh(), *exchange_, block(), kSeededRings, learner_.threads(), ranks_);
    num_seeds_ = own.size() + more.inserted;
    exchange_->check();
  }

  // Writes a checkpoint if one is due, and before work that would be lost: the end of a run that is over, and
  // R7.
  void save() {
    const bool is_last = is_over_ || (rounds_.back().deferred == 0 && problem_.dihedral_bounds);
    if (checkpoints_ == nullptr || !(is_last || checkpoints_->is_due())) return;
    checkpoints_->write(written_here(), rounds_.size());
  }

  // Returns the vertices in the cubes that this rank wrote last.
  std::vector<LearntVertex> written_here() const {
    const CubeSet cubes = exchange_->written();
    const Mesh& mesh = construction_.mesh();
    return parallel_collect<LearntVertex>(mesh.vertex_bound(), learner_.threads(),
                                          [&](std::size_t begin, std::size_t end, auto& found) {
                                            for (auto v = static_cast<VertexId>(begin); v < end; ++v) {
                                              const Vertex& vertex = mesh.vertex(v);
                                              if (is_shared(vertex.kind) && cubes.has(vertex.point))
                                                found.push_back({vertex.point, vertex.kind});
                                            }
                                          });
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
    zones_.emplace(grid_, *blocks_);
    load_.assign(static_cast<std::size_t>(ranks_.size()), 0);
    reach_over_radius_ = 1;
    std::vector<CellName> here;  // deferred cells that this rank's zone has
    do {
      const auto round = static_cast<int>(rounds.size());
      const bool is_first = round == 0, knows_seeds = is_first && task == Task::kRefine;
      RoundReport report;
      const CubeSet own = zones_->of(ranks_.rank());
      report.cubes = own.cubes().size();
      const double start_s = ranks_.report().computing_s;
      std::vector<CellName> left;
      if (!knows_seeds) {
        // A rank without cells learns its zone, too: it is the zone's writer from now on.
        report.update = exchange_->update(wanted(own, here));
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
      exchange_->note_writers(std::move(*zones_), own);
      here = plan_next(round, left, report);
      rounds.push_back(report);
      if (task == Task::kRefine) save();
    } while (rounds.back().deferred > 0 && !is_over_);
  }

  void add_names(const std::vector<CellId>& cells, std::vector<CellName>& names) const {
    const std::size_t before = names.size();
    names.resize(before + cells.size());
    for_each(cells.size(),
             [&](std::size_t i) { names[before + i] = name_of(construction_.mesh(), cells[i]); });
  }

  // Calls work(i) for i < count, on all threads of the rank.
  template <class Work>
  void for_each(std::size_t count, const Work& work) const {
    constexpr std::size_t kLength = 1 << 10;
    parallel_for_ranges(count, kLength, learner_.threads(),
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t i = begin; i < end; ++i) work(i);
                        });
  }

  // A poor cell whose ball reaches beyond the known cubes may be absent here. R7 does not try it.
  Construction::Entries first_entries(Task task) {
    if (task == Task::kRefine) return own_cells();
    Construction::Entries poor = own_poor_cells();
    perturbation_->before = count(poor);
    return poor;
  }

  void count_cells_of_all(std::size_t own) {
    std::array<std::uint64_t, 1> cells{own};
    ranks_.sum(cells);
    cells_of_all_ = static_cast<std::int64_t>(cells[0]);
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
    for (const KeptName& name : exchanged(kept)) {
      const auto cell = learner_.find_cell(name.cell.vertices);
      if (cell && unexplained.erase(*cell) > 0) ++report.unmoved[static_cast<std::size_t>(name.why)];
    }
    report.not_reached = unexplained.size();
    construction_.report(report);
  }

  // Returns the cubes whose vertices must be known in a zone with these deferred cells.
  CubeSet wanted(const CubeSet& own, const std::vector<CellName>& names) const {
    CubeSet wanted = own.grown(kKnownRings);
    for (const Waiting& here : by_cube(names))
      wanted.insert(here.largest.center, kKnownOverRadius * here.largest.radius_mm);
    return wanted;
  }

  // Groups cells by the cube of their center. The largest ball of a cube stands for all, because the other
  // balls hardly reach other places.
  std::vector<Waiting> by_cube(const std::vector<CellName>& names) const {
    std::vector<Waiting> each(names.size());
    for_each(names.size(), [&](std::size_t i) {
      const Ball ball = ball_of(names[i]);
      each[i] = {grid_.cube_at(ball.center), 1, ball};
    });
    parallel_sort(each.begin(), each.end(), learner_.threads(), [](const Waiting& a, const Waiting& b) {
      return a.cube != b.cube ? a.cube < b.cube : a.largest.radius_mm > b.largest.radius_mm;
    });
    std::vector<Waiting> by_cube;
    for (const Waiting& one : each) {
      if (by_cube.empty() || by_cube.back().cube != one.cube) {
        by_cube.push_back(one);
      } else {
        ++by_cube.back().cells;
      }
    }
    return by_cube;
  }

  // Returns an order in which walks to these cells are short.
  std::vector<std::size_t> along_curve(const std::vector<CellName>& names) const {
    std::vector<std::pair<MortonCode, std::size_t>> places(names.size());
    for_each(names.size(), [&](std::size_t i) {
      places[i] = {grid_.place_on_curve(names[i].vertices[0]), i};
    });
    parallel_sort(places.begin(), places.end(), learner_.threads());
    std::vector<std::size_t> order;
    for (const auto& place : places) order.push_back(place.second);
    return order;
  }

  // Returns the cells with these names in the zone. A cell that is not in the mesh has died if all vertices
  // are known that could be in its ball. Otherwise the cell is `left` for another round.
  Construction::Entries find(const std::vector<CellName>& names, const Zone& zone,
                             std::vector<CellName>& left) {
    const Mesh& mesh = construction_.mesh();
    const std::vector<std::size_t> order = along_curve(names);
    const auto cells = learner_.find_cells(
        names.size(), [&](std::size_t i) -> const auto& { return names[order[i]].vertices; });
    const auto is_left = [&](std::size_t i) {
      if (cells[i]) return false;
      const Ball ball = ball_of(names[order[i]]);
      return !zone.is_ball_known(ball.center, ball.radius_mm);
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

  // Informs all ranks where cells wait, divides space around these cells, and returns the cells of this
  // rank's zone.
  std::vector<CellName> plan_next(int round, const std::vector<CellName>& left, RoundReport& report) {
    std::array<std::uint64_t, 1> num_left{left.size()};
    ranks_.sum(num_left);
    report.deferred = num_left[0];
    is_over_ = is_over_anywhere();
    if (report.deferred == 0 || is_over_) return {};
    std::vector<CubeCount> num_waiting;
    const CubeSet waiting = share_waiting(left, round < kShiftedRounds ? nullptr : &num_waiting);
    zones_.emplace(
        zones_of_round(round + 1, *blocks_, waiting.grown(1), num_waiting, exchange_->writers(), load_));
    if (zones_->are_connected()) reach_over_radius_ *= 2;
    std::vector<int> rank_of(left.size());
    for_each(left.size(),
             [&](std::size_t i) { rank_of[i] = zones_->rank_of(grid_.place_of(ball_of(left[i]).center)); });
    std::vector<std::vector<CellName>> names(static_cast<std::size_t>(ranks_.size()));
    for (std::size_t i = 0; i < left.size(); ++i)
      names.at(static_cast<std::size_t>(rank_of[i])).push_back(left[i]);
    if (round < kShiftedRounds) add_load(names);
    std::vector<CellName> here = std::exchange(names[static_cast<std::size_t>(ranks_.rank())], {});
    const std::vector<CellName> more = exchanged(names);
    here.insert(here.end(), more.begin(), more.end());
    return here;
  }

  void add_load(const std::vector<std::vector<CellName>>& names) {
    std::vector<std::uint64_t> more;
    for (const std::vector<CellName>& of_rank : names) more.push_back(of_rank.size());
    ranks_.sum(more);
    std::transform(more.begin(), more.end(), load_.begin(), load_.begin(), std::plus<>());
  }

  // Returns the cubes that the deferred cells of all ranks request. Adds the numbers of cells with their
  // centers in each cube to `num_waiting`, if it is given.
  CubeSet share_waiting(const std::vector<CellName>& left, std::vector<CubeCount>* num_waiting) {
    CubeSet around(grid_), waiting(grid_);
    Bytes message;
    std::vector<CubeCount> counts;
    for (const Waiting& here : by_cube(left)) {
      around.insert(here.largest.center, reach_over_radius_ * here.largest.radius_mm);
      if (num_waiting != nullptr) counts.push_back({here.cube, here.cells});
    }
    append(message, around.runs());
    append(message, counts);
    for (const Bytes& received : ranks_.all_gather(std::move(message))) {
      MessageReader reader(received);
      for (const auto& run : reader.read<CubeRun>()) waiting.insert(run);
      for (const CubeCount& more : reader.read<CubeCount>()) num_waiting->push_back(more);
    }
    return waiting;
  }

  Ball ball_of(const CellName& name) const { return podm::ball_of(name, construction_.mesh().extent()); }

  // Returns what all ranks have for this one.
  template <class Value>
  std::vector<Value> exchanged(const std::vector<std::vector<Value>>& values) {
    std::vector<Value> here;
    for (const Bytes& received : ranks_.all_to_all(messages_of(values))) {
      const auto more = values_of<Value>(received);
      here.insert(here.end(), more.begin(), more.end());
    }
    return here;
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
  std::optional<Zones> zones_;          // of the round
  std::optional<LeavesOfZone> leaves_;  // unset: PODM alone
  double reach_over_radius_ = 1;        // the largest ball of a cube requests a zone within this many radii
  std::vector<std::uint64_t> load_;     // by rank: deferred cells assigned to it
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
