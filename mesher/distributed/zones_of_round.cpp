#include "distributed/zones_of_round.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace podm {

namespace {

// In a round that goes by blocks a cube is near those within so many cubes along each axis: in round 1
// farther than most of what waits lies from a face, and then farther each time, for cells wait again where
// zones met.
int near_in(int round) { return 2 + 3 * round; }
// Edges are where three blocks meet, or four, two of which end at the same face side by side.
std::size_t most_blocks_near(int round) { return round == 1 ? 2 : round == 2 ? 4 : ~std::size_t{0}; }
constexpr int kLastByBlocks = 4;
// Where fewer cells wait one rank may as well end it: another round takes as long.
constexpr std::uint64_t kCellsForBlocks = 10000;

std::vector<int> blocks_near(const Blocks& blocks, CubeId cube, int near) {
  const CubeGrid& grid = blocks.grid();
  const CubePlace at = grid.place_of(cube);
  CubePlace low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(0, at[axis] - near);
    high[axis] = std::min(grid.size()[axis] - 1, at[axis] + near);
  }
  return blocks.in(low, high);
}

constexpr std::size_t kNoZone = ~std::size_t{0};

// By cube: the number of its zone, or kNoZone. A zone is what is near the same blocks, at most so many: more
// are at corners.
std::vector<std::size_t> zones_near(const Blocks& blocks, const CubeSet& waiting, int near,
                                    std::size_t most_blocks) {
  std::vector<std::size_t> zone_of(waiting.grid().num_cubes(), kNoZone);
  std::map<std::vector<int>, std::size_t> zone_near;
  for (const CubeId cube : waiting.cubes()) {
    const std::vector<int> blocks_there = blocks_near(blocks, cube, near);
    if (blocks_there.size() <= most_blocks)
      zone_of[cube] = zone_near.emplace(blocks_there, zone_near.size()).first->second;
  }
  return zone_of;
}

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

// Blocks that have their part of a zone; if none has, all in it.
std::vector<int> candidates(const ZoneSize& zone) {
  constexpr double kLeastShare = 0.2;
  std::vector<int> blocks;
  for (const auto& [block, cubes] : zone.cubes_of_block)
    if (static_cast<double>(cubes) >= kLeastShare * static_cast<double>(zone.cubes)) blocks.push_back(block);
  if (blocks.empty())
    for (const auto& [block, cubes] : zone.cubes_of_block) blocks.push_back(block);
  return blocks;
}

// Zones move to ranks that would then have less than theirs has now, as long as there are such: each move
// lessens the sum of squares of what ranks have. `load` is what they had before, in cells, and becomes what
// they have.
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

double reach_over_radius(int round) { return round < 2 ? 0 : std::exp2(round - 2); }

std::vector<int> zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting,
                                const std::vector<std::uint32_t>& num_cells,
                                std::vector<std::uint64_t>& load) {
  const std::uint64_t all_cells = std::accumulate(num_cells.begin(), num_cells.end(), std::uint64_t{0});
  const bool is_by_blocks = round <= 2 || (round <= kLastByBlocks && all_cells >= kCellsForBlocks);
  std::vector<std::size_t> zone_of;
  if (is_by_blocks) zone_of = zones_near(blocks, waiting, near_in(round), most_blocks_near(round));
  const auto is_none = [](std::size_t zone) { return zone == kNoZone; };
  if (std::all_of(zone_of.begin(), zone_of.end(), is_none)) zone_of = connected_zones(waiting);
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
  for (const std::size_t zone : zone_of) rank_of_cube.push_back(zone == kNoZone ? kNobody : rank_of[zone]);
  return rank_of_cube;
}

}  // namespace podm
