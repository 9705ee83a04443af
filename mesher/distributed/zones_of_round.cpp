#include "distributed/zones_of_round.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace podm {

namespace {

// After this round, cells that still wait need more room than cuts leave.
constexpr int kLastWithCuts = 8;
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

// Assigns zones to ranks. A zone moves to another rank as long as that rank then has less than the zone's
// rank has now. Each move reduces the sum of squares of the loads. `load` holds the loads before, in cells,
// and receives the new loads.
std::vector<int> ranks_of(const std::vector<ZoneSize>& zones, std::vector<std::uint64_t>& load) {
  const auto of = [&](int rank) -> std::uint64_t& { return load[static_cast<std::size_t>(rank)]; };
  std::vector<int> rank_of;
  for (const ZoneSize& zone : zones) {
    rank_of.push_back(candidates(zone).front());
    of(rank_of.back()) += zone.cells;
  }
  for (bool has_moved = true; has_moved;) {
    has_moved = false;
    for (std::size_t i = 0; i < zones.size(); ++i) {
      for (const int rank : candidates(zones[i])) {
        if (of(rank) + zones[i].cells >= of(rank_of[i])) continue;
        of(rank_of[i]) -= zones[i].cells;
        of(rank) += zones[i].cells;
        rank_of[i] = rank;
        has_moved = true;
      }
    }
  }
  return rank_of;
}

}  // namespace

bool has_cuts(int round, std::uint64_t num_waiting) {
  return round <= kLastWithCuts && num_waiting >= 2 * kCellsPerZone;
}

std::vector<int> zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting,
                                const std::vector<std::uint32_t>& num_cells,
                                std::vector<std::uint64_t>& load) {
  const std::uint64_t all_cells = std::accumulate(num_cells.begin(), num_cells.end(), std::uint64_t{0});
  const std::size_t num_zones =
      std::min<std::uint64_t>(kZonesPerRank * load.size(), all_cells / kCellsPerZone);
  const std::vector<std::size_t> zone_of =
      has_cuts(round, all_cells) ? CutZones(waiting, num_cells, num_zones)() : connected_zones(waiting);
  std::vector<ZoneSize> zones;
  for (CubeId cube = 0; cube < zone_of.size(); ++cube) {
    if (zone_of[cube] == kNoZone) continue;
    zones.resize(std::max(zones.size(), zone_of[cube] + 1));
    ++zones[zone_of[cube]].cubes_of_block[blocks.of(cube)];
    ++zones[zone_of[cube]].cubes;
    zones[zone_of[cube]].cells += num_cells[cube];
  }
  const std::vector<int> rank_of = ranks_of(zones, load);
  std::vector<int> rank_of_cube;
  for (const std::size_t zone : zone_of) rank_of_cube.push_back(zone == kNoZone ? kNoRank : rank_of[zone]);
  return rank_of_cube;
}

}  // namespace podm
