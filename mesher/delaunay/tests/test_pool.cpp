#include <gtest/gtest.h>

#include <random>
#include <set>

#include "delaunay/pool.h"

namespace podm::test {
namespace {

constexpr int kNumNodes = 3;

// Workers of three nodes take ids and release arbitrary ones, as insertions and removals do.
TEST(FreeIds, AreOfTheWorkersNodeAlone) {
  IdArena arena(1 << 20, kNumNodes, 12);
  std::vector<FreeIds> workers;
  for (NodeIndex node = 0; node < 2 * kNumNodes; ++node)
    workers.emplace_back(arena, node % kNumNodes, 2 * kNumNodes);
  std::mt19937_64 random(1);
  std::vector<std::uint32_t> used;
  std::set<std::uint32_t> distinct;
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t self = random() % workers.size();
    const std::size_t wanted = random() % 40, released = std::min<std::size_t>(used.size(), random() % 40);
    workers[self].reserve(wanted, released);
    for (std::size_t k = 0; k < wanted; ++k) {
      used.push_back(workers[self].take());
      ASSERT_EQ(arena.node_of(used.back()), self % kNumNodes);
      ASSERT_TRUE(distinct.insert(used.back()).second) << "id " << used.back() << " is used twice";
    }
    for (std::size_t k = 0; k < released; ++k) {
      std::swap(used.back(), used[random() % used.size()]);
      workers[self].release(used.back());
      distinct.erase(used.back());
      used.pop_back();
    }
  }
}

// One node repeatedly releases the ids that another node took: the ids return home, and no new ones are
// needed.
TEST(FreeIds, GoHome) {
  IdArena arena(1 << 16, 2, 12);
  FreeIds maker(arena, 0, 2), eater(arena, 1, 2);
  for (int i = 0; i < 1'000; ++i) {
    maker.reserve(500, 0);
    eater.reserve(0, 500);
    for (int k = 0; k < 500; ++k) eater.release(maker.take());
  }
  EXPECT_LE(arena.bound(), 2u << 12);
}

TEST(IdArena, ReducesItsCapacityByTheLastNumberGiven) {
  IdArena arena(100, 1, 12);
  arena.take(10, 0);
  EXPECT_TRUE(arena.reduce_capacity(80));
  arena.take(10, 0);
  EXPECT_FALSE(arena.is_exhausted());
  EXPECT_THROW(arena.take(1, 0), std::bad_alloc);
  EXPECT_TRUE(arena.is_exhausted());
  EXPECT_TRUE(arena.reduce_capacity(70)) << "ten are given back";
  arena.take(10, 0);
  EXPECT_FALSE(arena.reduce_capacity(71)) << "thirty are taken";
  EXPECT_THROW(arena.take(1, 0), std::bad_alloc);
  EXPECT_FALSE(arena.reduce_capacity(1000));
}

TEST(IdArena, SharesIdsByNeedAndReturnsThem) {
  SharedIds shared;
  shared.add(100);
  IdArena small(100, 1, 12, &shared);
  small.take(10, 0);
  {
    IdArena large(100, 1, 12, &shared);
    large.take(70, 0);
    EXPECT_THROW(large.take(21, 0), std::bad_alloc);
    EXPECT_FALSE(large.is_exhausted()) << "the others have taken them";
    EXPECT_TRUE(large.reduce_capacity(15));
    EXPECT_THROW(small.take(6, 0), std::bad_alloc);
    EXPECT_TRUE(large.reduce_capacity(10)) << "five are given back";
    small.take(6, 0);
    EXPECT_FALSE(large.reduce_capacity(15)) << "fewer are left";
    EXPECT_THROW(large.take(1, 0), std::bad_alloc);
  }
  small.take(84, 0);
  EXPECT_THROW(small.take(1, 0), std::bad_alloc);
}

TEST(Pool, ReusesTheDyingCellsOfItsNode) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  Mesh mesh(box, 1 << 20, 2);
  Pool own(mesh, 0), other(mesh, 1);
  const auto make = [](Pool& pool, std::size_t count) {
    std::vector<CellId> created;
    pool.reserve({}, count, 0);
    pool.replace({}, count, created);
    return created;
  };
  std::vector<CellId> dying = make(own, 4);
  const std::vector<CellId> reused = dying, foreign = make(other, 4);
  dying.insert(dying.end(), foreign.begin(), foreign.end());
  std::vector<CellId> created;
  own.reserve(dying, 10, 0);
  own.replace(dying, 10, created);
  ASSERT_EQ(created.size(), 10u);
  EXPECT_TRUE(std::equal(reused.begin(), reused.end(), created.begin()));
  for (const CellId c : created) EXPECT_EQ(mesh.node_of_cell(c), 0);
}

}  // namespace
}  // namespace podm::test
