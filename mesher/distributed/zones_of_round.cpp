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
// Where blocks are shorter than this many cubes, all faces are shifted in one direction: too many cells would
// wait at the ends of stripes.
constexpr double kLeastStripe = 24;
// With fewer deferred cells a cut is not worth the round that it may cost.
constexpr std::uint64_t kCellsPerZone = 5000;
// More than one zone per rank, so that the load can be balanced.
constexpr std::uint64_t kZonesPerRank = 2;
// Cells within this many cubes on either side of a cut may have to wait again.
constexpr int kCubesBesideCut = 3;

// A cube in which cells wait, and the number of its zone.
struct WaitingCube {
  CubePlace at;
  std::uint64_t cells;
  std::size_t zone;
};
using WaitingCubes = std::vector<WaitingCube>;

// Cubes, and the zones that share them.
struct Part {
  std::vector<std::size_t> cubes;  // by number
  CubeRange range;
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
  CutZones(WaitingCubes& waiting, std::size_t first_zone) : waiting_(waiting), next_zone_(first_zone) {}

  void divide(const Part& part) {
    const PlaneCut cut = part.num_zones > 1 ? best_cut(part) : PlaneCut{};
    if (std::isinf(cut.cost)) {
      for (const std::size_t cube : part.cubes) waiting_[cube].zone = next_zone_;
      ++next_zone_;
      return;
    }
    Part lower{{}, part.range, part.num_zones / 2};
    Part upper{{}, part.range, part.num_zones - lower.num_zones};
    lower.range.high[cut.axis] = upper.range.low[cut.axis] = cut.at;
    for (const std::size_t cube : part.cubes)
      (waiting_[cube].at[cut.axis] < cut.at ? lower : upper).cubes.push_back(cube);
    divide(lower);
    divide(upper);
  }

 private:
  PlaneCut best_cut(const Part& part) const {
    PlaneCut best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PlaneCut cut = best_cut_across(axis, part);
      if (cut.cost < best.cost) best = cut;
    }
    return best;
  }

  // Returns, for each of the length + 1 planes across the axis, the number of the part's cells below it.
  std::vector<std::uint64_t> cells_below(const Part& part, std::size_t axis) const {
    std::vector<std::uint64_t> below(static_cast<std::size_t>(part.range.length(axis)) + 1);
    for (const std::size_t cube : part.cubes)
      below[static_cast<std::size_t>(waiting_[cube].at[axis] - part.range.low[axis]) + 1] +=
          waiting_[cube].cells;
    std::partial_sum(below.begin(), below.end(), below.begin());
    return below;
  }

  // The cost of a cut is the number of cells beside it over the product of the numbers on either side. (Shi
  // and Malik, IEEE TPAMI 2000.) Each side gets at least half of its share by number of zones.
  PlaneCut best_cut_across(std::size_t axis, const Part& part) const {
    const std::vector<std::uint64_t> cells = cells_below(part, axis);
    const int num_planes = part.range.length(axis);
    const auto below = [&](int plane) {
      return static_cast<double>(cells[static_cast<std::size_t>(std::clamp(plane, 0, num_planes))]);
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
      if (cost < best.cost) best = {axis, part.range.low[axis] + plane, cost};
    }
    return best;
  }

  WaitingCubes& waiting_;
  std::size_t next_zone_;
};

// Returns the cubes in order, in connected zones.
WaitingCubes connected_zones(const CubeNumbers& waiting, const std::vector<CubeCount>& num_cells) {
  const std::vector<std::uint32_t> components = waiting.cubes().components();
  WaitingCubes cubes;
  for (const CubeId cube : waiting.cubes().cubes())
    cubes.push_back({waiting.cubes().grid().place_of(cube), 0, components[cubes.size()]});
  for (const auto& [cube, cells] : num_cells) cubes[waiting[cube]].cells += cells;
  return cubes;
}

// Cuts zones with many deferred cells. Returns false if there is none.
bool cut_large(WaitingCubes& waiting, const CubeGrid& grid, std::size_t num_ranks) {
  std::vector<std::uint64_t> cells_of(waiting.size());  // by zone
  for (const WaitingCube& cube : waiting) cells_of[cube.zone] += cube.cells;
  Part large{{}, grid.all(), 0};
  std::uint64_t cells = 0;
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    if (cells_of[waiting[i].zone] < 2 * kCellsPerZone) continue;
    large.cubes.push_back(i);
    cells += waiting[i].cells;
  }
  if (cells == 0) return false;
  large.num_zones = std::min<std::uint64_t>(kZonesPerRank * num_ranks, cells / kCellsPerZone);
  CutZones(waiting, waiting.size()).divide(large);
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

}  // namespace

// The stripes are as long as the mean block. Their ends lie elsewhere in each round.
Zones::Zones(int round, CubeSet waiting, const Blocks& blocks, const Writers& writers)
    : grid_(&waiting.grid()),
      waiting_(std::move(waiting)),
      blocks_(&blocks),
      writers_(&writers),
      shift_(kCubesPerShift * round) {
  const double length = std::cbrt(grid_->num_cubes() / static_cast<double>(blocks.number()));
  if (length < kLeastStripe) return;
  stripe_ = 1 + static_cast<int>(length);
  const std::array<int, kShiftedRounds> begins{stripe_ / 2, 2 * stripe_ / 3, stripe_ / 3, stripe_ / 6};
  first_stripe_ = begins.at(static_cast<std::size_t>(round - 1));
}

// The direction of a face depends on the place along the next axis, so that it is the same on both sides.
int Zones::shifted_block(const CubePlace& at) const {
  CubePlace from;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_upwards = stripe_ == 0 || (at[(axis + 1) % 3] + first_stripe_) / stripe_ % 2 == 0;
    from[axis] = std::clamp(at[axis] + (is_upwards ? -shift_ : shift_), 0, grid_->size()[axis] - 1);
  }
  return blocks_->of(from);
}

int Zones::rank_of(const CubePlace& at) const {
  const CubeId cube = grid_->id(at);
  if (numbered_) return is_waiting(cube) ? rank_of_waiting(at) : kNoRank;
  const int rank = shifted_block(at);
  return are_blocks() || is_waiting(cube) || writers_->of(at) == rank ? rank : kNoRank;
}

CubeSet Zones::of(int rank) const {
  CubeSet zone(*grid_);
  if (numbered_) {
    const std::vector<CubeId> cubes = numbered_->cubes().cubes();
    for (std::size_t i = 0; i < cubes.size(); ++i)
      if (ranks_[i] == rank) zone.insert(cubes[i]);
    return zone;
  }
  const CubeRange range = grid_->grown(blocks_->range_of(rank), shift_);
  if (are_blocks()) {
    zone.insert(range);
  } else {
    grid_->for_each(range, [&](CubeId, const CubePlace& at) {
      if (rank_of(at) == rank) zone.insert(at);
    });
  }
  return zone;
}

int Writers::of(const CubePlace& at) const {
  const CubeId cube = grid_.id(at);
  for (auto zones = later_.rbegin(); zones != later_.rend(); ++zones)
    if (zones->is_waiting(cube)) return zones->rank_of_waiting(at);
  return blocks_.of(at);
}

// A rank that has a cube in which no cell waits in its zone wrote the cube last before, too.
void Writers::note(Zones zones) {
  if (zones.are_blocks()) return later_.clear();
  later_.push_back(std::move(zones));
}

Zones zones_of_round(int round, const Blocks& blocks, CubeSet waiting,
                     const std::vector<CubeCount>& num_cells, const Writers& writers,
                     std::vector<std::uint64_t>& load) {
  const CubeGrid& grid = waiting.grid();
  if (round <= kShiftedRounds) return {round, std::move(waiting), blocks, writers};
  CubeNumbers numbered(std::move(waiting));
  WaitingCubes cubes = connected_zones(numbered, num_cells);
  const bool has_cuts = round <= kLastRoundWithCuts && cut_large(cubes, grid, load.size());
  std::map<std::size_t, ZoneSize> zones;
  for (const WaitingCube& cube : cubes) {
    ZoneSize& zone = zones[cube.zone];
    ++zone.cubes_of_block[blocks.of(cube.at)];
    ++zone.cubes;
    zone.cells += cube.cells;
  }
  const std::map<std::size_t, int> rank_of_zone = ranks_of(zones, load);
  std::vector<int> rank_of;
  for (const WaitingCube& cube : cubes) rank_of.push_back(rank_of_zone.at(cube.zone));
  return {std::move(numbered), std::move(rank_of), !has_cuts};
}

}  // namespace podm
