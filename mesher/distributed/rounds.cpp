#include "distributed/rounds.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

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

// What the coarse mesh says of the cells to come, by cube.
std::vector<double> predicted_cells(const Mesh& mesh, const Problem& problem, const CubeGrid& grid) {
  const auto label_of = [&](CellId c) { return problem.isosurface.label_at(mesh.cell(c).center); };
  std::vector<double> cells(grid.num_cubes());
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    const Cell& cell = mesh.cell(c);
    const LabelIndex label = cell.is_alive() ? label_of(c) : kBackground;
    if (label == kBackground) continue;
    double area_mm2 = 0;
    for (unsigned k = 0; k < 4; ++k)
      if (cell.mirrors[k] == kNoFacet || label_of(cell_of(cell.mirrors[k])) != label)
        area_mm2 += area_of_facet(mesh, cell, k);
    const double squared_radius = problem.sizes.squared_radius(label);
    const double radius_mm = std::isinf(squared_radius) ? 0 : std::sqrt(squared_radius);
    cells[grid.cube_at(cell.center)] +=
        CostModel::cells(volume_of(mesh, cell), area_mm2, radius_mm, problem.delta_mm);
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
        construction_(problem, levels_.clamp, team, stop) {}

  DistributedRefinement operator()() {
    refine_anywhere(construction_, "initial", levels_.initial, construction_.all_cells(), 1);
    const CubeGrid grid(problem_.object, cube_side_mm(radii_of(problem_), problem_.object, ranks_.size()));
    const Blocks blocks(grid, predicted_cells(construction_.mesh(), problem_, grid), ranks_.size());
    const CubeSet shared = blocks.near_others(kSharedRings);
    for (const auto& entry : construction_.all_cells()) construction_.mesh().make_canonical(entry.cell);
    VertexExchange exchange(ranks_, construction_.mesh(), construction_.pool(0), grid);
    DistributedRefinement result{
        .refinement = {}, .grid = grid, .rank_of_cube = {}, .rounds = {}, .last_update = {}};
    for (CubeId cube = 0; cube < grid.num_cubes(); ++cube) result.rank_of_cube.push_back(blocks.of(cube));

    std::vector<int> zone_of(result.rank_of_cube);  // by cube: whose zone it is in, or nobody's
    std::vector<CellName> deferred;                 // of the last round, here now
    for (int round = 0;; ++round) {
      RoundReport report;
      const CubeSet own = cubes_of(ranks_.rank(), zone_of, grid);
      report.cubes = own.cubes().size();
      const auto start = processor_seconds();
      const bool knows_all = round == 0;
      CubeSet known = own.grown(kKnownRings);
      for (const CellName& name : deferred) {
        const Point center = sphere_of(name, construction_.mesh().extent()).center;
        if (own.has(center)) known.insert(center, kKnownOverRadius * distance(center, name.vertices[0]));
      }
      const Zone zone = knows_all ? Zone(own, shared) : Zone(own, shared, known, kKnownRings);
      Construction::Entries entries;
      std::vector<CellName> left;
      if (knows_all) {
        entries = cells_in(own);
      } else {
        report.update = exchange.update(known);
        entries = find(deferred, own, known, exchange, left);
      }
      drop_sound(entries, zone);
      report.update_s = processor_seconds() - start;
      report.entries = entries.size();
      const auto middle = processor_seconds();
      for (const CellId c : refine_in(zone, entries, report))
        left.push_back(name_of(construction_.mesh(), c));
      report.refine_s = processor_seconds() - middle;
      for (CubeId cube = 0; cube < grid.num_cubes(); ++cube)
        if (zone_of[cube] != kNobody) exchange.note_writer(cube, zone_of[cube]);
      const bool is_last = plan_next(round, blocks, left, zone_of, deferred, report);
      result.rounds.push_back(report);
      if (is_last) break;
    }
    result.last_update = complete(exchange, result.rank_of_cube, grid);
    result.refinement = construction_.finish();
    return result;
  }

 private:
  static CubeSet cubes_of(int rank, const std::vector<int>& rank_of_cube, const CubeGrid& grid) {
    CubeSet cubes(grid);
    for (CubeId cube = 0; cube < grid.num_cubes(); ++cube)
      if (rank_of_cube[cube] == rank) cubes.insert(cube);
    return cubes;
  }

  Construction::Entries cells_in(const CubeSet& cubes) {
    Construction::Entries entries = construction_.all_cells();
    std::erase_if(
        entries, [&](const auto& entry) { return !cubes.has(construction_.mesh().cell(entry.cell).center); });
    return entries;
  }

  // The cells of these names in the zone. Those that are not in the mesh have died, if all is known that
  // could be in their balls; else they are `left` for another round, with those that are in nobody's zone.
  Construction::Entries find(const std::vector<CellName>& names, const CubeSet& own, const CubeSet& known,
                             VertexExchange& exchange, std::vector<CellName>& left) {
    const Mesh& mesh = construction_.mesh();
    Construction::Entries entries;
    for (const CellName& name : names) {
      const Point center = sphere_of(name, mesh.extent()).center;
      if (!own.has(center)) {
        left.push_back(name);
      } else if (const auto cell = exchange.find_cell(name.vertices)) {
        entries.push_back({*cell, mesh.stamp(*cell)});
      } else if (!known.covers(center, distance(center, name.vertices[0]) * (1 + kMargin))) {
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

  // All ranks learn where cells were deferred, and get those of their next zones. True: there are none, or
  // the run is over.
  bool plan_next(int round, const Blocks& blocks, const std::vector<CellName>& left,
                 std::vector<int>& zone_of, std::vector<CellName>& deferred, RoundReport& report) {
    std::array<std::uint64_t, 2> sums{left.size(), stop_.is_over() ? 1u : 0u};
    ranks_.sum(sums);
    report.deferred = sums[0];
    if (sums[0] == 0 || sums[1] > 0) return true;
    const CubeGrid& grid = blocks.grid();
    std::vector<CubeId> cube_of_left;
    CubeSet here(grid), active(grid);
    for (const CellName& name : left) {
      const Point center = sphere_of(name, construction_.mesh().extent()).center;
      cube_of_left.push_back(grid.cube_at(center));
      here.insert(center, reach_over_radius(round + 1) * distance(center, name.vertices[0]));
    }
    Bytes message;
    append(message, here.cubes());
    for (const Bytes& told : ranks_.all_gather(std::move(message)))
      for (const CubeId cube : MessageReader(told).read<CubeId>()) active.insert(cube);
    zone_of = zones_of_round(round + 1, blocks, active.grown(1));
    std::vector<std::vector<CellName>> names(static_cast<std::size_t>(ranks_.size()));
    for (std::size_t i = 0; i < left.size(); ++i) {
      const int rank = zone_of[cube_of_left[i]];  // nobody's wait here
      names[static_cast<std::size_t>(rank == kNobody ? ranks_.rank() : rank)].push_back(left[i]);
    }
    std::vector<Bytes> messages(names.size());
    for (std::size_t rank = 0; rank < names.size(); ++rank)
      if (!names[rank].empty()) append(messages[rank], names[rank]);
    deferred.clear();
    for (const Bytes& told : ranks_.all_to_all(std::move(messages))) {
      if (told.empty()) continue;
      const auto more = MessageReader(told).read<CellName>();
      deferred.insert(deferred.end(), more.begin(), more.end());
    }
    return false;
  }

  // Learns what others have changed until every cell with a vertex in the block is one of the whole.
  Update complete(VertexExchange& exchange, const std::vector<int>& rank_of_cube, const CubeGrid& grid) {
    const Mesh& mesh = construction_.mesh();
    const CubeSet block = cubes_of(ranks_.rank(), rank_of_cube, grid);
    CubeSet known = block.is_empty() ? block : block.grown(kKnownRings);
    Update sum;
    for (;;) {
      sum += exchange.update(known);
      const std::size_t num_known = known.cubes().size();
      for (CellId c = 0; c < mesh.cell_bound() && num_known > 0; ++c) {
        const Cell& cell = mesh.cell(c);
        if (!cell.is_alive()) continue;
        if (std::none_of(cell.vertices.begin(), cell.vertices.end(),
                         [&](VertexId v) { return block.has(mesh.point(v)); }))
          continue;
        known.insert(cell.center, distance(cell.center, mesh.point(cell.vertices[0])) * (1 + kMargin));
      }
      std::array<std::uint64_t, 1> more{known.cubes().size() - num_known};
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
};

}  // namespace

DistributedRefinement podm_distributed(const Problem& problem, const Team& team, double initial_ratio,
                                       Communication& ranks, StopControl& stop) {
  return Rounds(problem, team, initial_ratio, ranks, stop)();
}

}  // namespace podm
