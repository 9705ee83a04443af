#include "distributed/zones_of_round.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace podm {

namespace {

constexpr std::size_t kMostAtEdge = 4;  // two that end at the same face may lie side by side
constexpr int kNear = 5;                // cubes; farther than most of what waits lies from a face

std::vector<int> blocks_near(const Blocks& blocks, CubeId cube) {
  const CubeGrid& grid = blocks.grid();
  const CubePlace at = grid.place_of(cube);
  CubePlace low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(0, at[axis] - kNear);
    high[axis] = std::min(grid.size()[axis] - 1, at[axis] + kNear);
  }
  std::vector<int> near;
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const int block = blocks.of(grid.id({x, y, z}));
        if (std::find(near.begin(), near.end(), block) == near.end()) near.push_back(block);
      }
  std::sort(near.begin(), near.end());
  return near;
}

constexpr std::size_t kNoZone = ~std::size_t{0};

// By cube: the number of its zone, or kNoZone.
std::vector<std::size_t> zones_near_two(const Blocks& blocks, const CubeSet& waiting) {
  std::vector<std::size_t> zone_of(waiting.grid().num_cubes(), kNoZone);
  std::map<std::vector<int>, std::size_t> zone_near;
  for (const CubeId cube : waiting.cubes()) {
    const std::vector<int> near = blocks_near(blocks, cube);
    if (near.size() <= 2) zone_of[cube] = zone_near.emplace(near, zone_near.size()).first->second;
  }
  return zone_of;
}

std::vector<std::size_t> connected_zones(const CubeSet& waiting) {
  const std::vector<std::uint32_t> components = waiting.components();
  std::vector<std::size_t> zone_of(components.size(), kNoZone);
  for (const CubeId cube : waiting.cubes()) zone_of[cube] = components[cube];
  return zone_of;
}

// Without those near corners, where blocks are more, which would connect all edges.
std::vector<std::size_t> zones_of_edges(const Blocks& blocks, const CubeSet& waiting) {
  CubeSet along_edges(waiting.grid());
  for (const CubeId cube : waiting.cubes())
    if (blocks_near(blocks, cube).size() <= kMostAtEdge) along_edges.insert(cube);
  return connected_zones(along_edges);
}

struct ZoneSize {
  std::map<int, std::size_t> cubes_of_block;
  std::size_t cubes = 0;
};

// The largest zone first, each to the rank whose block is in it that has the least by then, but not to one
// that has little of it.
std::vector<int> ranks_of(const std::vector<ZoneSize>& zones, int num_ranks) {
  constexpr double kLeastShare = 0.2;
  std::vector<std::size_t> order(zones.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return zones[a].cubes > zones[b].cubes; });
  std::vector<int> rank_of(zones.size(), kNobody);
  std::vector<std::size_t> load(static_cast<std::size_t>(num_ranks));
  for (const std::size_t i : order) {
    const ZoneSize& zone = zones[i];
    int& rank = rank_of[i];
    for (const auto& [block, cubes] : zone.cubes_of_block) {
      const double share = static_cast<double>(cubes) / static_cast<double>(zone.cubes);
      const bool has_least =
          rank == kNobody || load[static_cast<std::size_t>(block)] < load[static_cast<std::size_t>(rank)];
      if (share >= kLeastShare && has_least) rank = block;
    }
    if (rank == kNobody) rank = zone.cubes_of_block.begin()->first;
    load[static_cast<std::size_t>(rank)] += zone.cubes;
  }
  return rank_of;
}

}  // namespace

double reach_over_radius(int round) { return round < 2 ? 0 : std::exp2(round - 2); }

std::vector<int> zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting) {
  const std::vector<std::size_t> zone_of = round == 1   ? zones_near_two(blocks, waiting)
                                           : round == 2 ? zones_of_edges(blocks, waiting)
                                                        : connected_zones(waiting);
  std::vector<ZoneSize> zones;
  for (CubeId cube = 0; cube < zone_of.size(); ++cube) {
    if (zone_of[cube] == kNoZone) continue;
    zones.resize(std::max(zones.size(), zone_of[cube] + 1));
    ++zones[zone_of[cube]].cubes_of_block[blocks.of(cube)];
    ++zones[zone_of[cube]].cubes;
  }
  const std::vector<int> rank_of = ranks_of(zones, blocks.number());
  std::vector<int> rank_of_cube;
  for (const std::size_t zone : zone_of) rank_of_cube.push_back(zone == kNoZone ? kNobody : rank_of[zone]);
  return rank_of_cube;
}

}  // namespace podm
