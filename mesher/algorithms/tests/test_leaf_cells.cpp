#include "algorithms/leaf_cells.h"

#include <gtest/gtest.h>

#include <set>

#include "octree/tests/refinement_queue_state.h"

namespace podm::test {
namespace {

// A box that is one leaf, for two nodes.
class OneLeaf : public testing::Test {
 protected:
  LeafCells::Entries entries(std::initializer_list<CellId> cells) const {
    LeafCells::Entries made;
    for (const CellId c : cells) made.push_back({c, mesh_.stamp(c)});
    return made;
  }

  static constexpr double kSide = 8;
  const Box box_{{0, 0, 0}, {kSide, kSide, kSide}};
  Mesh mesh_{box_, 1 << 10};
  Octree octree_{box_.low, box_.high, kSide, [](const Point&, const Point&) { return kSide; },
                 [](const Point&, const Point&) { return true; }};
  LeafCells cells_{mesh_, octree_};
  RefinementQueue queue_{octree_, 2};
};

// Another node lists a cell of a leaf between the moments when its number and its cells are taken: the cell
// goes with the others, and the leaf is handed out once more, with none.
TEST_F(OneLeaf, CellsThatComeLateAreTakenOnce) {
  cells_.add(entries({0, 1}), queue_, {});
  const auto leaf = pop(queue_, 0);
  ASSERT_TRUE(leaf);
  cells_.add(entries({2}), queue_, {});
  std::multiset<CellId> taken;
  for (const auto& entry : cells_.take(*leaf)) taken.insert(entry.cell);
  queue_.finish(*leaf);
  const auto again = pop(queue_, 1);
  ASSERT_TRUE(again);
  for (const auto& entry : cells_.take(*again)) taken.insert(entry.cell);
  queue_.finish(*again);
  EXPECT_EQ(taken, (std::multiset<CellId>{0, 1, 2}));
  EXPECT_FALSE(pop(queue_, 0));
}

TEST_F(OneLeaf, ListsNothingWhenTheRunIsOver) {
  std::stop_source over;
  over.request_stop();
  cells_.add(entries({0}), queue_, over.get_token());
  EXPECT_FALSE(pop(queue_, 0));
  EXPECT_TRUE(cells_.take(0).empty());
}

TEST_F(OneLeaf, WhatIsDeferredIsLeftOver) {
  cells_.add(entries({0}), queue_, {});
  cells_.defer(entries({1, 2}));
  std::multiset<CellId> left;
  for (const auto& entry : cells_.take_leftover()) left.insert(entry.cell);
  EXPECT_EQ(left, (std::multiset<CellId>{1, 2}));
}

}  // namespace
}  // namespace podm::test
