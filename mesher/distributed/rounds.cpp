#include "distributed/rounds.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "algorithms/leaf_size.h"
#include "algorithms/podm_impl.h"
#include "cost_model.h"
#include "distributed/messages.h"
#include "distributed/zone.h"
#include "distributed/zones_of_round.h"
#include "runtime/processor_seconds.h"

namespace podm {

namespace {

// What is known reaches so many cubes beyond zones.
constexpr int kKnownRings = 1;
// Cells so many cubes from other blocks are known to one rank alone, but for some of the last rounds.
constexpr int kSharedRings = 8;
// And around a deferred cell so many circumradii, so that most of its neighbours are known.
constexpr double kKnownOverRadius = 2;
// Cubes are so many bounds of a circumradius long.
constexpr double kCubeOverRadius = 2;

struct CubeCount {
  CubeId cube;
  std::uint32_t cells;
};

// A cell as other ranks know it.
struct CellName {
  std::array<Point, 4> vertices;
};

CellName name_of(const Mesh& mesh, CellId c) {
  CellName name;
  for (std::size_t i = 0; i < 4; ++i) name.vertices[i] = mesh.point(mesh.cell(c).vertices[i]);
  std::sort(name.vertices.begin(), name.vertices.end(), lexicographically_less);
  return name;
}

Circumsphere sphere_of(const CellName& name, double extent) {
  const auto& v = name.vertices;
  return circumsphere(v[0], v[1], v[2], v[3], extent);
}

double volume_of(const Mesh& mesh, const Cell& cell) {
  const Point& a = mesh.point(cell.vertices[0]);
  const auto edge = [&](std::size_t i) { return mesh.point(cell.vertices[i]) - a; };
  return dot(cross(edge(1), edge(2)), edge(3)) / 6;
}

double area_of_facet(const Mesh& mesh, const Cell& cell, unsigned k) {
  const auto point = [&](std::size_t i) {
    return mesh.point(cell.vertices[static_cast<unsigned>(kFacetVertices[k][i])]);
  };
  return std::sqrt(squared_length(cross(point(1) - point(0), point(2) - point(0)))) / 2;
}

// What the coarse mesh says of the cells to come, by cube, in millionths: whole numbers, whose sums are
// exact.
std::vector<std::uint64_t> predicted_cells(const Mesh& mesh, const Problem& problem, const CubeGrid& grid) {
  constexpr double kParts = 1e6;
  const auto label_of = [&](CellId c) { return problem.isosurface.label_at(mesh.cell(c).center); };
  std::vector<std::uint64_t> cells(grid.num_cubes());
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    const Cell& cell = mesh.cell(c);
    if (!cell.is_alive()) continue;
    const LabelIndex label = label_of(c);
    if (label == kBackground) continue;
    double area_mm2 = 0;
    for (unsigned k = 0; k < 4; ++k)
      if (cell.mirrors[k] == kNoFacet || label_of(cell_of(cell.mirrors[k])) != label)
        area_mm2 += area_of_facet(mesh, cell, k);
    const double squared_radius = problem.sizes.squared_radius(label);
    const double radius_mm = std::isinf(squared_radius) ? 0 : std::sqrt(squared_radius);
    cells[grid.cube_at(cell.center)] += static_cast<std::uint64_t>(
        kParts * CostModel::cells(volume_of(mesh, cell), area_mm2, radius_mm, problem.delta_mm));
  }
  return cells;
}

// As long as most cells need, unless blocks would then be coarse.
double cube_side_mm(const Radii& radii, const Box& object, int num_ranks) {
  constexpr double kCubesABlock = 512;
  const Vector extent = object.high - object.low;
  const double share_mm3 = extent.x * extent.y * extent.z / num_ranks;
  return std::max(kCubeOverRadius * radii.least,
                  std::min(kCubeOverRadius * radii.most, std::cbrt(share_mm3 / kCubesABlock)));
}

class Rounds {
 public:
  Rounds(const Problem& problem, const Team& team, double initial_ratio, Communication& ranks,
         StopControl& stop)
      : problem_(problem),
        team_(team),
        ranks_(ranks),
        stop_(stop),
        levels_(two_levels(problem, initial_ratio)),
        construction_(problem, levels_.clamp, team, stop),
        grid_(problem.object, cube_side_mm(radii_of(problem), problem.object, ranks.size())),
        exchange_(ranks, construction_.mesh(), construction_.pool(0), grid_, team.log) {}

  DistributedRefinement operator()() {
    refine_anywhere(construction_, "initial", levels_.initial, construction_.all_cells(), 1);
    construction_.timed("refine", [] {});  // every rank of every run has this phase
    if (is_over_anywhere()) return all_of_first_rank();
    for (const auto& entry : construction_.all_cells()) construction_.mesh().make_canonical(entry.cell);
    blocks_.emplace(grid_, predicted_cells(construction_.mesh(), problem_, grid_), ranks_.size());
    shared_.emplace(blocks_->near_others(kSharedRings));
    refine_in_rounds();
    const Update last_update = complete();
    return {.refinement = construction_.finish(),
            .grid = grid_,
            .rank_of_cube = exchange_.writers(),
            .rounds = std::move(rounds_),
            .last_update = last_update};
  }

 private:
  bool is_over_anywhere() {
    std::array<std::uint64_t, 1> num_over{stop_.is_over() ? 1u : 0u};
    ranks_.sum(num_over);
    return num_over[0] > 0;
  }

  // Coarse meshes that were not finished differ.
  DistributedRefinement all_of_first_rank() {
    if (team_.log != nullptr && ranks_.rank() > 0) team_.log->restart();
    return {.refinement = construction_.finish(),
            .grid = grid_,
            .rank_of_cube = std::vector<int>(grid_.num_cubes(), 0),
            .rounds = {},
            .last_update = {}};
  }

  // A cell is its rank's whose block has its least vertex.
  bool is_own(const Cell& cell) const {
    const Mesh& mesh = construction_.mesh();
    Point least = mesh.point(cell.vertices[0]);
    for (const VertexId v : cell.vertices)
      if (lexicographically_less(mesh.point(v), least)) least = mesh.point(v);
    return blocks_->of(grid_.cube_at(least)) == ranks_.rank();
  }

  // Until nothing waits, or the run is over.
  void refine_in_rounds() {
    zone_of_ = blocks_->ranks();
    load_.assign(static_cast<std::size_t>(ranks_.size()), 0);
    std::vector<CellName> here;  // what waits, and is to be refined here
    do {
      const auto round = static_cast<int>(rounds_.size());
      RoundReport report;
      const CubeSet own = cubes_of(ranks_.rank(), zone_of_);
      report.cubes = own.cubes().size();
      const double start_s = processor_seconds();
      std::vector<CellName> left;
      if (round > 0) report.update = exchange_.update(wanted(own, here));
      const Zone zone(own, *shared_, exchange_.known(), kKnownRings);
      Construction::Entries entries = round == 0 ? own_cells() : find(here, zone, left);
      drop_sound(entries, zone);
      report.entries = entries.size();
      report.update_s = processor_seconds() - start_s;
      if (team_.log != nullptr) team_.log->begin_step();
      for (const CellId c : refine_in(zone, entries, report))
        left.push_back(name_of(construction_.mesh(), c));
      report.refine_s = processor_seconds() - start_s - report.update_s;
      for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
        if (zone_of_[cube] != kNobody) exchange_.note_writer(cube, zone_of_[cube]);
      here = plan_next(round, left, report);
      rounds_.push_back(report);
    } while (rounds_.back().deferred > 0 && !is_over_);
  }

  CubeSet cubes_of(int rank, const std::vector<int>& rank_of_cube) const {
    CubeSet cubes(grid_);
    for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
      if (rank_of_cube[cube] == rank) cubes.insert(cube);
    return cubes;
  }

  Construction::Entries own_cells() {
    Construction::Entries entries = construction_.all_cells();
    std::erase_if(entries, [&](const auto& entry) { return !is_own(construction_.mesh().cell(entry.cell)); });
    return entries;
  }

  // What has to be known of a zone in which these cells wait.
  CubeSet wanted(const CubeSet& own, const std::vector<CellName>& names) const {
    CubeSet wanted = own.grown(kKnownRings);
    for (const CellName& name : names) {
      const Point center = center_of(name);
      if (own.has(center)) wanted.insert(center, kKnownOverRadius * distance(center, name.vertices[0]));
    }
    return wanted;
  }

  // The cells of these names in the zone. Those that are not in the mesh have died, if all is known that
  // could be in their balls; else they are `left` for another round, with those that are in nobody's zone.
  Construction::Entries find(const std::vector<CellName>& names, const Zone& zone,
                             std::vector<CellName>& left) {
    const Mesh& mesh = construction_.mesh();
    Construction::Entries entries;
    for (const CellName& name : names) {
      const Point center = center_of(name);
      if (!zone.has(center)) {
        left.push_back(name);
      } else if (const auto cell = exchange_.find_cell(name.vertices)) {
        entries.push_back({*cell, mesh.stamp(*cell)});
      } else if (!zone.is_ball_known(center, distance(center, name.vertices[0]))) {
        left.push_back(name);
      }
    }
    return entries;
  }

  // Nobody changes anything yet: so cells may be looked at that lie across zones, which nobody could later.
  // Most of the large cells far from the object are of this kind.
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
    std::erase_if(entries,
                  [&](const auto& entry) { return is_known(entry.cell) && rules.is_sound(entry.cell); });
  }

  std::vector<CellId> refine_in(const Zone& zone, const Construction::Entries& entries, RoundReport& report) {
    if (construction_.num_workers() > 1) return refine_with<VertexLocks>(zone, entries, report);
    return refine_with<NoLocks>(zone, entries, report);
  }

  // Returns those that need what lies outside.
  template <class Inner>
  std::vector<CellId> refine_with(const Zone& zone, const Construction::Entries& entries,
                                  RoundReport& report) {
    std::vector<CellId> deferred;
    if (entries.empty() || stop_.is_over()) return deferred;
    const Mesh& mesh = construction_.mesh();
    construction_.timed("refine", [&] {
      const auto workers =
          construction_.make_workers<ZoneLocks<Inner>>(levels_.final, construction_.num_workers());
      for (const auto& worker : workers) worker->locks().confine(zone);
      construction_.in_time("refine", construction_.num_workers(), [&](auto& time) {
        refine(construction_, workers, coordination_of_first(team_, construction_.num_workers()), entries,
               time);
      });
      for (const auto& worker : workers) {
        for (const std::uint64_t count : worker->counters().insertions_by_rule) report.insertions += count;
        for (const auto& entry : worker->take_deferred())
          if (mesh.stamp(entry.cell) == entry.stamp) deferred.push_back(entry.cell);
      }
    });
    return deferred;
  }

  // All ranks learn where cells wait, divide space around them, and get those of their zones.
  std::vector<CellName> plan_next(int round, const std::vector<CellName>& left, RoundReport& report) {
    std::array<std::uint64_t, 1> num_left{left.size()};
    ranks_.sum(num_left);
    report.deferred = num_left[0];
    is_over_ = is_over_anywhere();
    if (report.deferred == 0 || is_over_) return {};
    const CubeSet waiting = share_waiting(round + 1, left);
    zone_of_ = zones_of_round(round + 1, *blocks_, waiting.grown(1), num_waiting_, load_);
    std::vector<std::vector<CellName>> names(static_cast<std::size_t>(ranks_.size()));
    for (std::size_t i = 0; i < left.size(); ++i) {
      const int rank = zone_of_[grid_.cube_at(center_of(left[i]))];
      names[static_cast<std::size_t>(rank == kNobody ? ranks_.rank() : rank)].push_back(left[i]);
    }
    return exchanged(names);
  }

  // The cubes for which cells of all ranks ask; num_waiting_ are the cells with their centres there.
  CubeSet share_waiting(int round, const std::vector<CellName>& left) {
    std::map<CubeId, std::uint32_t> here;  // cells by cube
    CubeSet around(grid_), waiting(grid_);
    for (const CellName& name : left) {
      const Point center = center_of(name);
      ++here[grid_.cube_at(center)];
      around.insert(center, reach_over_radius(round) * distance(center, name.vertices[0]));
    }
    Bytes message;
    std::vector<CubeCount> counts;
    for (const auto& [cube, cells] : here) counts.push_back({cube, cells});
    append(message, around.cubes());
    append(message, counts);
    num_waiting_.assign(grid_.num_cubes(), 0);
    for (const Bytes& told : ranks_.all_gather(std::move(message))) {
      MessageReader reader(told);
      for (const CubeId cube : reader.read<CubeId>()) waiting.insert(cube);
      for (const auto& [cube, cells] : reader.read<CubeCount>()) num_waiting_[cube] += cells;
    }
    return waiting;
  }

  Point center_of(const CellName& name) const {
    return sphere_of(name, construction_.mesh().extent()).center;
  }

  std::vector<CellName> exchanged(const std::vector<std::vector<CellName>>& names) {
    std::vector<Bytes> messages(names.size());
    for (std::size_t rank = 0; rank < names.size(); ++rank)
      if (!names[rank].empty()) append(messages[rank], names[rank]);
    std::vector<CellName> here;
    for (const Bytes& told : ranks_.all_to_all(std::move(messages))) {
      if (told.empty()) continue;
      const auto more = MessageReader(told).read<CellName>();
      here.insert(here.end(), more.begin(), more.end());
    }
    return here;
  }

  // Learns what others have changed until every cell with a vertex in what this rank wrote last is one of the
  // whole.
  Update complete() {
    const Mesh& mesh = construction_.mesh();
    const CubeSet own = cubes_of(ranks_.rank(), exchange_.writers());
    CubeSet wanted = own.grown(kKnownRings);
    Update sum;
    for (;;) {
      sum += exchange_.update(wanted);
      const Zone zone(own, *shared_, exchange_.known(), kKnownRings);
      std::array<std::uint64_t, 1> more{0};
      for (CellId c = 0; c < mesh.cell_bound(); ++c) {
        const Cell& cell = mesh.cell(c);
        if (!cell.is_alive() || zone.knows(cell)) continue;
        if (std::none_of(cell.vertices.begin(), cell.vertices.end(),
                         [&](VertexId v) { return own.has(mesh.point(v)); }))
          continue;
        wanted.insert(cell.center, distance(cell.center, mesh.point(cell.vertices[0])) * (1 + kMargin));
        ++more[0];
      }
      ranks_.sum(more);
      if (more[0] == 0) return sum;
    }
  }

  const Problem& problem_;
  const Team& team_;
  Communication& ranks_;
  StopControl& stop_;
  const TwoLevels levels_;
  Construction construction_;
  const CubeGrid grid_;
  VertexExchange exchange_;
  std::optional<Blocks> blocks_;
  std::optional<CubeSet> shared_;
  std::vector<int> zone_of_;                // by cube: the rank of the zone that it is in, or kNobody
  std::vector<std::uint32_t> num_waiting_;  // by cube: cells, on all ranks, before the round
  std::vector<std::uint64_t> load_;         // by rank: cells that waited for it
  std::vector<RoundReport> rounds_;
  bool is_over_ = false;  // on all ranks
};

}  // namespace

DistributedRefinement podm_distributed(const Problem& problem, const Team& team, double initial_ratio,
                                       Communication& ranks, StopControl& stop) {
  return Rounds(problem, team, initial_ratio, ranks, stop)();
}

}  // namespace podm
