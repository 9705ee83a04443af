#include "distributed/zones_of_round.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace podm {

namespace {

// The shift of blocks from round to round, in cubes. A larger shift requires more vertices of other ranks,
// and thin blocks come to lie over each other. With a smaller one the deferred cells of a face lack room.
constexpr int kCubesPerShift = 2;
// With fewer deferred cells a cut is not worth the round that it may cost.
constexpr std::uint64_t kCellsPerZone = 5000;
// More than one zone per rank, so that the load can be balanced.
constexpr std::uint64_t kZonesPerRank = 2;
// Cells within this many cubes on either side of a cut may have to wait again.
constexpr int kCubesBesideCut = 3;

constexpr std::size_t kNoZone = ~std::size_t{0};

// Cubes, and the zones that share them.
struct Part {
  CubeRange cubes;
  std::size_t num_zones;
};

struct PlaneCut {
  std::size_t axis = 0;
  int at = 0;
  double cost = std::numeric_limits<double>::infinity();
};

// Divides space into parts with about equal numbers of deferred cells. The cuts are where few cells lie.
class CutZones {
 public:
  CutZones(const CubeSet& waiting, const std::vector<std::uint32_t>& num_cells, std::size_t num_zones)
      : waiting_(waiting), num_cells_(num_cells), zone_of_(waiting.grid().num_cubes(), kNoZone) {
    divide({waiting.grid().all(), num_zones});
  }
  /// Returns the number of each cube's zone, or kNoZone.
  const std::vector<std::size_t>& operator()() const { return zone_of_; }

 private:
  void divide(const Part& part) {
    const PlaneCut cut = part.num_zones > 1 ? best_cut(part) : PlaneCut{};
    if (std::isinf(cut.cost)) {
      waiting_.grid().for_each(part.cubes, [&](CubeId cube, const CubePlace&) {
        if (waiting_.has(cube)) zone_of_[cube] = next_zone_;
      });
      ++next_zone_;
      return;
    }
    Part lower = part, upper = part;
    lower.cubes.high[cut.axis] = upper.cubes.low[cut.axis] = cut.at;
    lower.num_zones = part.num_zones / 2;
    upper.num_zones -= lower.num_zones;
    divide(lower);
    divide(upper);
  }

  PlaneCut best_cut(const Part& part) const {
    PlaneCut best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PlaneCut cut = best_cut_across(axis, part);
      if (cut.cost < best.cost) best = cut;
    }
    return best;
  }

  // The cost of a cut is the number of cells beside it over the product of the numbers on either side. (Shi
  // and Malik, IEEE TPAMI 2000.) Each side gets at least half of its share by number of zones.
  PlaneCut best_cut_across(std::size_t axis, const Part& part) const {
    const std::vector<std::uint64_t> cells_below =
        waiting_.grid().weights_below(part.cubes, axis, num_cells_);
    const int num_planes = part.cubes.length(axis);
    const auto below = [&](int plane) {
      return static_cast<double>(cells_below[static_cast<std::size_t>(std::clamp(plane, 0, num_planes))]);
    };
    const double all = below(num_planes);
    const double least_below =
        0.5 * all * static_cast<double>(part.num_zones / 2) / static_cast<double>(part.num_zones);
    const double most_below = 0.5 * all + least_below;
    PlaneCut best{.axis = axis};
    for (int plane = 1; plane < num_planes && all > 0; ++plane) {
      if (below(plane) < least_below || below(plane) > most_below) continue;
      const double beside = below(plane + kCubesBesideCut) - below(plane - kCubesBesideCut);
      const double cost = (1 + beside) / (below(plane) * (all - below(plane)));
      if (cost < best.cost) best = {axis, part.cubes.low[axis] + plane, cost};
    }
    return best;
  }

  const CubeSet& waiting_;
  const std::vector<std::uint32_t>& num_cells_;
  std::vector<std::size_t> zone_of_;
  std::size_t next_zone_ = 0;
};

std::vector<std::size_t> connected_zones(const CubeSet& waiting) {
  const std::vector<std::uint32_t> components = waiting.components();
  std::vector<std::size_t> zone_of(components.size(), kNoZone);
  for (const CubeId cube : waiting.cubes()) zone_of[cube] = components[cube];
  return zone_of;
}

// Cuts zones with many deferred cells. Returns false if there is none.
bool cut_large(std::vector<std::size_t>& zone_of, const CubeSet& waiting,
               const std::vector<std::uint32_t>& num_cells, std::size_t num_ranks) {
  const std::vector<CubeId> cubes = waiting.cubes();
  std::vector<std::uint64_t> cells_of(cubes.size());  // by zone
  for (const CubeId cube : cubes) cells_of[zone_of[cube]] += num_cells[cube];
  CubeSet large(waiting.grid());
  std::vector<std::uint32_t> cells_in_large(num_cells.size());
  std::uint64_t cells = 0;
  for (const CubeId cube : cubes) {
    if (cells_of[zone_of[cube]] < 2 * kCellsPerZone) continue;
    large.insert(cube);
    cells += cells_in_large[cube] = num_cells[cube];
  }
  if (cells == 0) return false;
  const std::size_t num_zones = std::min<std::uint64_t>(kZonesPerRank * num_ranks, cells / kCellsPerZone);
  const std::vector<std::size_t> parts = CutZones(large, cells_in_large, num_zones)();
  for (const CubeId cube : large.cubes()) zone_of[cube] = cubes.size() + parts[cube];
  return true;
}

struct ZoneSize {
  std::map<int, std::size_t> cubes_of_block;
  std::size_t cubes = 0, cells = 0;
};

// Returns the blocks with a sufficient share of a zone; if there is none, all blocks in the zone.
std::vector<int> candidates(const ZoneSize& zone) {
  constexpr double kLeastShare = 0.2;
  std::vector<int> blocks;
  for (const auto& [block, cubes] : zone.cubes_of_block)
    if (static_cast<double>(cubes) >= kLeastShare * static_cast<double>(zone.cubes)) blocks.push_back(block);
  if (blocks.empty())
    for (const auto& [block, cubes] : zone.cubes_of_block) blocks.push_back(block);
  return blocks;
}

// Assigns zones to ranks, both by number of zone. A zone moves to another rank as long as that rank then has
// less than the zone's rank has now. Each move reduces the sum of squares of the loads. `load` holds the
// loads before, in cells, and receives the new loads.
std::map<std::size_t, int> ranks_of(const std::map<std::size_t, ZoneSize>& zones,
                                    std::vector<std::uint64_t>& load) {
  const auto of = [&](int rank) -> std::uint64_t& { return load[static_cast<std::size_t>(rank)]; };
  std::map<std::size_t, int> rank_of;
  for (const auto& [number, zone] : zones) of(rank_of[number] = candidates(zone).front()) += zone.cells;
  for (bool has_moved = true; has_moved;) {
    has_moved = false;
    for (const auto& [number, zone] : zones) {
      for (const int rank : candidates(zone)) {
        if (of(rank) + zone.cells >= of(rank_of[number])) continue;
        of(rank_of[number]) -= zone.cells;
        of(rank) += zone.cells;
        rank_of[number] = rank;
        has_moved = true;
      }
    }
  }
  return rank_of;
}

std::vector<int> shifted_blocks(int round, const Blocks& blocks, const CubeSet& waiting,
                                const std::vector<std::uint32_t>& num_cells,
                                const std::vector<int>& writer_of_cube, std::vector<std::uint64_t>& load) {
  const CubeGrid& grid = waiting.grid();
  std::vector<int> rank_of_cube(grid.num_cubes(), kNoRank);
  grid.for_each(grid.all(), [&](CubeId cube, CubePlace at) {
    for (int& place : at) place = std::max(0, place - kCubesPerShift * round);
    const int rank = blocks.of(grid.id(at));
    if (!waiting.has(cube) && writer_of_cube[cube] != rank) return;
    rank_of_cube[cube] = rank;
    load[static_cast<std::size_t>(rank)] += num_cells[cube];
  });
  return rank_of_cube;
}

}  // namespace

Zones zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting,
                     const std::vector<std::uint32_t>& num_cells, const std::vector<int>& writer_of_cube,
                     std::vector<std::uint64_t>& load) {
  if (round <= kShiftedRounds)
    return {shifted_blocks(round, blocks, waiting, num_cells, writer_of_cube, load)};
  std::vector<std::size_t> zone_of = connected_zones(waiting);
  const bool has_cuts = round <= kLastRoundWithCuts && cut_large(zone_of, waiting, num_cells, load.size());
  std::map<std::size_t, ZoneSize> zones;
  for (const CubeId cube : waiting.cubes()) {
    ZoneSize& zone = zones[zone_of[cube]];
    ++zone.cubes_of_block[blocks.of(cube)];
    ++zone.cubes;
    zone.cells += num_cells[cube];
  }
  const std::map<std::size_t, int> rank_of = ranks_of(zones, load);
  std::vector<int> rank_of_cube(zone_of.size(), kNoRank);
  for (const CubeId cube : waiting.cubes()) rank_of_cube[cube] = rank_of.at(zone_of[cube]);
  return {std::move(rank_of_cube), !has_cuts};
}

}  // namespace podm
