// Blocks divide the weight of cubes evenly, and the zones of later rounds keep their ranks apart.
#include "distributed/zones_of_round.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "distributed/in_process_ranks.h"

namespace podm::test {
namespace {

constexpr int kRoundOfCuts = kShiftedRounds + 1;
constexpr int kRoundOfConnected = kLastRoundWithCuts + 1;

CubeGrid cubes_of_1_mm(double x, double y, double z) { return CubeGrid({{0, 0, 0}, {x, y, z}}, 1); }

// Returns large weights in the middle, small ones outside, and none in a corner.
std::vector<std::uint32_t> hill(const CubeGrid& grid) {
  std::vector<std::uint32_t> weights;
  for (CubeId cube = 0; cube < grid.num_cubes(); ++cube) {
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      squared += std::pow((grid.place_of(cube)[axis] + 0.5) / grid.size()[axis] - 0.4, 2);
    weights.push_back(squared > 0.6 ? 0 : static_cast<std::uint32_t>(1e6 * std::exp(-4 * squared)));
  }
  return weights;
}

// Returns the blocks that ranks make which each know a part of the weights.
Blocks blocks_by(const CubeGrid& grid, const std::vector<std::uint32_t>& weights, int num_blocks) {
  std::vector<std::optional<Blocks>> blocks(static_cast<std::size_t>(num_blocks));
  run_ranks({.num_ranks = num_blocks, .one_at_a_time = true}, [&](Communication& ranks) {
    const auto rank = static_cast<std::size_t>(ranks.rank());
    const auto begin_of = [&](std::size_t part) {
      return static_cast<std::ptrdiff_t>(weights.size() * part * part / blocks.size() / blocks.size());
    };
    const CubeWork own{static_cast<CubeId>(begin_of(rank)),
                       {weights.begin() + begin_of(rank), weights.begin() + begin_of(rank + 1)}};
    blocks[rank].emplace(grid, own, ranks);
  });
  grid.for_each(grid.all(), [&](CubeId, const CubePlace& at) {
    for (const auto& of_rank : blocks) ASSERT_EQ(of_rank->of(at), blocks[0]->of(at));
    ASSERT_TRUE(blocks[0]->range_of(blocks[0]->of(at)).has(at));
  });
  return *blocks[0];
}

bool touch(const CubePlace& a, const CubePlace& b) {
  return std::abs(a[0] - b[0]) <= 1 && std::abs(a[1] - b[1]) <= 1 && std::abs(a[2] - b[2]) <= 1;
}

TEST(WeighedBlocks, ShareTheWeightAsEvenlyAsPlanesOfCubesCan) {
  const CubeGrid grid = cubes_of_1_mm(40, 30, 30);
  const std::vector<std::uint32_t> weights = hill(grid);
  const auto total = static_cast<double>(std::accumulate(weights.begin(), weights.end(), std::uint64_t{0}));
  for (const int num_blocks : {1, 2, 3, 5, 8, 13}) {
    std::vector<double> share(static_cast<std::size_t>(num_blocks));
    const Blocks blocks = blocks_by(grid, weights, num_blocks);
    grid.for_each(grid.all(), [&](CubeId cube, const CubePlace& at) {
      share[static_cast<std::size_t>(blocks.of(at))] += static_cast<double>(weights[cube]) / total;
    });
    for (const double one : share) EXPECT_NEAR(one * num_blocks, 1, 0.15) << "of " << num_blocks << " blocks";
  }
}

TEST(WeighedBlocks, AreThereWithoutCubesWhereRanksAreMore) {
  const CubeGrid grid = cubes_of_1_mm(2, 1, 1);
  const Blocks blocks = blocks_by(grid, {1, 1}, 9);
  EXPECT_NE(blocks.of({0, 0, 0}), blocks.of({1, 0, 0}));
}

class ZonesOfRound : public testing::TestWithParam<int> {
 protected:
  // Returns the cubes along the faces of blocks, where cells wait in real runs.
  CubeSet along_faces() const { return along_faces_of(Zones(grid_, blocks_)); }
  CubeSet along_faces_of(const Zones& zones) const {
    CubeSet waiting(grid_);
    grid_.for_each(grid_.all(), [&](CubeId cube, const CubePlace& at) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        CubePlace next = at;
        if (++next[axis] == grid_.size()[axis]) continue;
        const int part = zones.rank_of(at), beyond = zones.rank_of(next);
        if (part != beyond && part != kNoRank && beyond != kNoRank) waiting.insert(cube);
      }
    });
    return waiting;
  }
  // Returns the same number of cells for each cube of `waiting`.
  static std::vector<CubeCount> cells_in(const CubeSet& waiting, std::uint32_t cells) {
    std::vector<CubeCount> num_cells;
    for (const CubeId cube : waiting.cubes()) num_cells.push_back({cube, cells});
    return num_cells;
  }
  Zones zones(const CubeSet& waiting, std::uint32_t cells) {
    return zones_of_round(GetParam(), blocks_, waiting, cells_in(waiting, cells), writers_, load_);
  }
  std::vector<int> ranks_of(const Zones& zones) const {
    std::vector<int> ranks;
    grid_.for_each(grid_.all(), [&](CubeId, const CubePlace& at) { ranks.push_back(zones.rank_of(at)); });
    return ranks;
  }
  bool is_shifted() const { return GetParam() <= kShiftedRounds; }
  bool is_cut() const { return !is_shifted() && GetParam() <= kLastRoundWithCuts; }

  static constexpr int kRanks = 8;
  static constexpr std::uint32_t kMany = 100;  // cells per cube, enough for several ranks to get zones
  const CubeGrid grid_ = cubes_of_1_mm(60, 60, 60);
  const Blocks blocks_ = blocks_by(grid_, hill(grid_), kRanks);
  Writers writers_{grid_, blocks_};
  std::vector<std::uint64_t> load_ = std::vector<std::uint64_t>(kRanks);
};

TEST_P(ZonesOfRound, AreOfAllThatWaitsAndOtherwiseOfTheWriterAtMost) {
  for (const std::uint32_t cells : {0u, 1u, kMany}) {
    const CubeSet waiting = along_faces();
    const std::vector<int> rank_of = ranks_of(zones(waiting, cells));
    for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube) {
      ASSERT_LT(rank_of[cube], kRanks);
      if (waiting.has(cube)) {
        ASSERT_NE(rank_of[cube], kNoRank);
      } else if (rank_of[cube] != kNoRank) {
        ASSERT_TRUE(is_shifted());
        ASSERT_EQ(rank_of[cube], blocks_.of(grid_.place_of(cube)));
      }
    }
  }
}

// A cube is in the zone of one rank at most, and each rank enumerates its zone.
TEST_P(ZonesOfRound, AreEnumeratedByRank) {
  for (const std::uint32_t cells : {0u, kMany}) {
    const Zones all = zones(along_faces(), cells);
    const std::vector<int> rank_of = ranks_of(all);
    for (int rank = 0; rank < kRanks; ++rank) {
      const CubeSet zone = all.of(rank);
      for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
        ASSERT_EQ(zone.has(cube), rank_of[cube] == rank);
    }
  }
}

TEST_P(ZonesOfRound, AddTheirCellsToTheLoadOfTheirRanks) {
  if (is_shifted()) return;
  const std::vector<std::uint64_t> before{5000, 0, 0, 700, 0, 0, 0, 1};
  load_ = before;
  const CubeSet waiting = along_faces();
  const std::vector<int> rank_of = ranks_of(zones(waiting, kMany));
  std::vector<std::uint64_t> expected = before;
  for (const CubeId cube : waiting.cubes()) expected.at(static_cast<std::size_t>(rank_of[cube])) += kMany;
  EXPECT_EQ(load_, expected);
}

// Ranks take only zones that overlap their blocks, so the load is uneven.
TEST_P(ZonesOfRound, AreForMostRanksWhereMuchWaits) {
  if (!is_cut()) return;
  const CubeSet waiting = along_faces();
  zones(waiting, kMany);
  EXPECT_LE(std::count(load_.begin(), load_.end(), 0u), kRanks / 4);
  const std::size_t mean = kMany * waiting.cubes().size() / kRanks;
  EXPECT_LE(*std::max_element(load_.begin(), load_.end()), 2 * mean);
}

// The number of waiting cells where zones meet decreases much in each round; otherwise there would be many
// rounds.
TEST_P(ZonesOfRound, MeetWhereLittleWaits) {
  const CubeSet waiting = along_faces();
  const CubeSet meeting = along_faces_of(zones(waiting, kMany));
  const std::vector<CubeId> cubes = waiting.cubes();
  EXPECT_LT(6 * std::count_if(cubes.begin(), cubes.end(), [&](CubeId cube) { return meeting.has(cube); }),
            std::ssize(cubes));
}

// The faces of blocks and of blocks shifted one to three times have a common place nearly nowhere, because a
// place is on few faces at once.
TEST_F(ZonesOfRound, NearlyAllCellsAreRefinedByTheLastShiftedRound) {
  CubeSet waiting = along_faces();
  const std::size_t before = waiting.cubes().size();
  for (int round = 1; round <= kShiftedRounds; ++round) {
    Zones zones = zones_of_round(round, blocks_, waiting.grown(1), {}, writers_, load_);
    EXPECT_FALSE(zones.are_connected());
    const CubeSet meeting = along_faces_of(zones);
    for (const CubeId cube : waiting.cubes())
      if (!meeting.has(cube)) waiting.erase(cube);
    std::vector<int> expected = ranks_of(zones);
    grid_.for_each(grid_.all(), [&](CubeId cube, const CubePlace& at) {
      if (expected[cube] == kNoRank) expected[cube] = writers_.of(at);
    });
    writers_.note(std::move(zones));
    grid_.for_each(grid_.all(),
                   [&](CubeId cube, const CubePlace& at) { ASSERT_EQ(writers_.of(at), expected[cube]); });
  }
  EXPECT_LT(1000 * waiting.cubes().size(), before);
}

TEST_P(ZonesOfRound, DoNotTouchThoseOfOthersInTheEndOrWhereLittleWaits) {
  std::mt19937_64 random(1);
  CubeSet waiting(grid_);
  for (int i = 0; i < 800; ++i) {
    const auto drawn = [&] { return 20 + static_cast<int>(random() % 20); };
    waiting.insert(grid_.id({drawn(), drawn(), drawn()}));
  }
  if (is_shifted()) return;
  const std::vector<int> rank_of = ranks_of(zones(waiting, is_cut() ? 1 : kMany));
  const std::vector<CubeId> cubes = waiting.cubes();
  std::set<int> ranks(rank_of.begin(), rank_of.end());
  ranks.erase(kNoRank);
  EXPECT_GT(ranks.size(), 2u);
  for (const CubeId a : cubes)
    for (const CubeId b : cubes)
      if (touch(grid_.place_of(a), grid_.place_of(b))) {
        ASSERT_EQ(rank_of[a], rank_of[b]);
      }
}

TEST_P(ZonesOfRound, AreNoneWhereNothingWaits) {
  if (is_shifted()) return;
  const std::vector<int> rank_of = ranks_of(zones(CubeSet(grid_), kMany));
  EXPECT_TRUE(std::all_of(rank_of.begin(), rank_of.end(), [](int rank) { return rank == kNoRank; }));
}

// Every round must make progress even if all cells wait in one place. Where cuts do not help, there are fewer
// zones.
TEST_P(ZonesOfRound, AreThereWhereAllWaitInFewCubes) {
  for (const std::vector<int>& places : {std::vector{29}, {2, 50}, {0, 1, 59}, {10, 11, 12, 40, 41}}) {
    CubeSet waiting(grid_);
    for (const int x : places) waiting.insert(grid_.id({x, 29, 29}));
    const std::vector<int> rank_of = ranks_of(zones(waiting, 1000 * kMany));
    for (const CubeId cube : waiting.cubes()) EXPECT_NE(rank_of[cube], kNoRank);
  }
}

TEST_P(ZonesOfRound, AreCutInTheMiddleOfWhatIsEmpty) {
  if (!is_cut()) return;
  const CubeGrid row = cubes_of_1_mm(40, 1, 1);
  const Blocks halves = blocks_by(row, std::vector<std::uint32_t>(row.num_cubes(), 1), 2);
  CubeSet waiting(row);
  std::vector<CubeCount> num_cells;
  for (CubeId cube = 0; cube < row.num_cubes(); ++cube) {
    waiting.insert(cube);
    if (cube < 12 || cube > 27) num_cells.push_back({cube, 500});  // 12000 in all: two zones
  }
  std::vector<std::uint64_t> load(2);
  const Zones zones = zones_of_round(GetParam(), halves, waiting, num_cells, {row, halves}, load);
  EXPECT_FALSE(zones.are_connected());
  for (const CubeCount& one : num_cells)
    EXPECT_EQ(zones.rank_of(row.place_of(one.cube)), one.cube < 20 ? 0 : 1);
  EXPECT_EQ(load, (std::vector<std::uint64_t>{6000, 6000}));
}

// Only large parts are cut. Parts that are not cut must grow for the rounds to end.
TEST_P(ZonesOfRound, AreCutWhereTheyAreLargeAndTheRoundIsEarly) {
  CubeSet waiting(grid_);
  std::vector<CubeCount> num_cells;
  for (int x = 0; x < 60; ++x) {
    const CubeId small = grid_.id({x, 10, 10}), large = grid_.id({x, 40, 40});
    waiting.insert(small);
    waiting.insert(large);
    num_cells.push_back({small, 1});
    num_cells.push_back({large, 600});
    num_cells.push_back({large, 400});
  }
  const Zones zones = zones_of_round(GetParam(), blocks_, waiting, num_cells, writers_, load_);
  EXPECT_EQ(zones.are_connected(), GetParam() >= kRoundOfConnected);
  const auto ranks_along = [&](int y, int z) {
    std::set<int> ranks;
    for (int x = 0; x < 60; ++x) ranks.insert(zones.rank_of({x, y, z}));
    return ranks.size();
  };
  if (!is_shifted()) {
    EXPECT_EQ(ranks_along(10, 10), 1u);
  }
  EXPECT_EQ(ranks_along(40, 40) > 1, GetParam() < kRoundOfConnected);
}

INSTANTIATE_TEST_SUITE_P(Rounds, ZonesOfRound,
                         testing::Values(1, kShiftedRounds, kRoundOfCuts, kLastRoundWithCuts,
                                         kRoundOfConnected, 20));

TEST(Components, AreTheCubesThatChainsOfNeighboursJoin) {
  const CubeGrid grid = cubes_of_1_mm(7, 6, 5);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    CubeSet set(grid);
    for (CubeId cube = 0; cube < grid.num_cubes(); ++cube)
      if (random() % 8 == 0) set.insert(cube);
    const std::vector<std::uint32_t> component = set.components();
    const std::vector<CubeId> cubes = set.cubes();
    std::vector<std::uint32_t> least(grid.num_cubes());  // least cube that chains have joined so far
    for (const CubeId cube : cubes) least[cube] = cube;
    for (std::size_t length = 0; length < cubes.size(); ++length)
      for (const CubeId a : cubes)
        for (const CubeId b : cubes)
          if (touch(grid.place_of(a), grid.place_of(b))) least[a] = std::min(least[a], least[b]);
    ASSERT_EQ(component.size(), cubes.size());
    for (std::size_t i = 0; i < cubes.size(); ++i)
      for (std::size_t j = 0; j < cubes.size(); ++j)
        ASSERT_EQ(component[i] == component[j], least[cubes[i]] == least[cubes[j]]);
  }
}

}  // namespace
}  // namespace podm::test
