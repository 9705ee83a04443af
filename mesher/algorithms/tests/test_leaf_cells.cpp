#include "algorithms/leaf_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "algorithms/podm.h"
#include "image/foreground.h"
#include "octree/tests/refinement_queue_state.h"
#include "refine/virtual_box.h"
#include "runtime/parallel_for.h"
#include "tests/images.h"

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

// Another node lists a cell of a leaf after the leaf is popped and before its cells are taken: the cell goes
// with the others, and the leaf is handed out once more, with no cells.
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

// The mesh of a ball, with several slices, on leaves around a gap that contains the ball's middle and all but
// a part of its surface. Cells have died in every slice.
class Distribution : public testing::Test {
 protected:
  Distribution() {
    refine_anywhere(construction_, "initial", parameters_for(problem_, 1, clamp_), construction_.all_cells(),
                    1);
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (!mesh_.cell(c).is_alive()) continue;
      const LeafId leaf = octree_.leaf_at(mesh_.cell(c).center);
      (leaf == kNoLeaf ? outside_ : of_leaf_[leaf]).push_back(c);
    }
  }

  std::vector<std::size_t> slices(const LeafCells& cells) const {
    std::vector<std::size_t> all(cells.num_slices());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  static std::vector<CellId> ids(const LeafCells::Entries& entries) {
    std::vector<CellId> cells;
    for (const auto& entry : entries) cells.push_back(entry.cell);
    return cells;
  }
  bool are_up_to_date(const LeafCells::Entries& entries) const {
    return std::all_of(entries.begin(), entries.end(),
                       [&](const auto& entry) { return mesh_.stamp(entry.cell) == entry.stamp; });
  }
  // Every living cell is once in the leaf that contains its center, or in none, by ascending id.
  void expect_all_by_id(LeafCells& cells) const {
    for (LeafId leaf = 0; leaf < octree_.num_leaves(); ++leaf) {
      const LeafCells::Entries taken = cells.take(leaf);
      EXPECT_TRUE(are_up_to_date(taken));
      EXPECT_EQ(ids(taken), of_leaf_[leaf]) << "leaf " << leaf;
      EXPECT_TRUE(cells.take(leaf).empty());
    }
    const LeafCells::Entries left = cells.take_leftover();
    EXPECT_TRUE(are_up_to_date(left));
    EXPECT_EQ(ids(left), outside_);
  }

  LabelImage image_ = ball(24, 9);
  Isosurface isosurface_{image_, 1};
  Box clamp_ = clamp_box(foreground_bounds(image_), 1);
  Problem problem_{.isosurface = isosurface_,
                   .object = foreground_bounds(image_),
                   .delta_mm = 1,
                   .sizes = SizeField(std::vector<double>(2, 1)),
                   .cell_capacity = 1 << 20};
  Team team_;
  StopControl stop_{{}, {}, [](std::uint64_t) {}};
  Construction construction_{problem_, clamp_, team_, stop_};
  const Mesh& mesh_ = construction_.mesh();
  Octree octree_{clamp_.low, clamp_.high, 4, [](const Point&, const Point&) { return 4.0; },
                 [this](const Point& low, const Point& high) {
                   const Point middle = 0.5 * (clamp_.low + clamp_.high);
                   return distance(0.5 * (low + high), middle) > 5;
                 }};
  std::vector<std::vector<CellId>> of_leaf_ = std::vector<std::vector<CellId>>(octree_.num_leaves());
  std::vector<CellId> outside_;
};

TEST_F(Distribution, ListsEveryLivingCellOnceWhateverTheOrderOfSlices) {
  LeafCells cells(mesh_, octree_);
  ASSERT_GE(cells.num_slices(), 4u);
  ASSERT_GT(octree_.num_leaves(), 50u);
  ASSERT_GT(outside_.size(), 100u);
  std::vector<std::size_t> order = slices(cells);
  std::reverse(order.begin(), order.end());
  std::uint64_t num_cells = 0;
  for (const std::size_t slice : order) num_cells += cells.distribute(slice);
  EXPECT_EQ(num_cells, mesh_.num_cells());
  expect_all_by_id(cells);
}

TEST_F(Distribution, ListsEveryLivingCellOnceOnAnyNumberOfThreads) {
  for (const std::size_t threads : {1, 2, 8}) {
    LeafCells cells(mesh_, octree_);
    parallel_for(cells.num_slices(), threads,
                 [&](std::size_t slice, std::size_t) { cells.distribute(slice); });
    expect_all_by_id(cells);
  }
}

TEST_F(Distribution, ListsOnlyTheCellsThatAreGiven) {
  LeafCells::Entries some = construction_.all_cells();
  std::erase_if(some, [](const auto& entry) { return entry.cell % 3 != 0; });
  LeafCells cells(mesh_, octree_, &some);
  ASSERT_GE(cells.num_slices(), 2u);
  std::uint64_t num_cells = 0;
  for (const std::size_t slice : slices(cells)) num_cells += cells.distribute(slice);
  EXPECT_EQ(num_cells, some.size());
  for (LeafId leaf = 0; leaf < octree_.num_leaves(); ++leaf) {
    std::erase_if(of_leaf_[leaf], [](CellId c) { return c % 3 != 0; });
    EXPECT_EQ(ids(cells.take(leaf)), of_leaf_[leaf]) << "leaf " << leaf;
  }
}

TEST_F(Distribution, ListsEveryLeafThatHasCellsInTheQueue) {
  LeafCells cells(mesh_, octree_);
  RefinementQueue queue(octree_, 2);
  for (const std::size_t slice : slices(cells)) cells.distribute(slice);
  cells.share_out(queue, {});
  std::set<LeafId> listed;
  while (const auto leaf = pop(queue, 0)) {
    EXPECT_TRUE(listed.insert(*leaf).second);
    queue.finish(*leaf);
  }
  for (LeafId leaf = 0; leaf < octree_.num_leaves(); ++leaf)
    EXPECT_EQ(listed.count(leaf) == 1, !of_leaf_[leaf].empty()) << "leaf " << leaf;
}

TEST_F(Distribution, ListsNothingInTheQueueWhenTheRunIsOver) {
  LeafCells cells(mesh_, octree_);
  RefinementQueue queue(octree_, 2);
  for (const std::size_t slice : slices(cells)) cells.distribute(slice);
  std::stop_source over;
  over.request_stop();
  cells.share_out(queue, over.get_token());
  EXPECT_EQ(RefinementQueueState(queue).counts().pending, 0u);
}

// Refined leaves hand cells over to a leaf that still has its distributed cells.
TEST_F(Distribution, CellsAddedComeAfterThoseDistributedAsTheyWereAdded) {
  LeafCells cells(mesh_, octree_);
  RefinementQueue queue(octree_, 2);
  for (const std::size_t slice : slices(cells)) cells.distribute(slice);
  const auto leaf =
      static_cast<LeafId>(std::max_element(of_leaf_.begin(), of_leaf_.end(),
                                           [](const auto& a, const auto& b) { return a.size() < b.size(); }) -
                          of_leaf_.begin());
  std::vector<CellId> expected = of_leaf_[leaf];
  LeafCells::Entries added;
  for (auto c = of_leaf_[leaf].rbegin(); c != of_leaf_[leaf].rend(); ++c) {
    added.push_back({*c, mesh_.stamp(*c)});
    expected.push_back(*c);
  }
  cells.add(added, queue, {});
  EXPECT_EQ(ids(cells.take(leaf)), expected);
}

// As many nodes as there are threads end leaves at the same time. The cells belong to all leaves.
TEST_F(Distribution, CellsThatNodesAddAtTheSameTimeAreTakenOnce) {
  constexpr std::size_t kNodes = 8;
  LeafCells cells(mesh_, octree_);
  RefinementQueue queue(octree_, kNodes);
  const LeafCells::Entries all = construction_.all_cells();
  parallel_for(kNodes, kNodes, [&](std::size_t node, std::size_t) {
    for (std::size_t i = node; i < all.size(); i += 64 * kNodes) {
      LeafCells::Entries some;
      for (std::size_t j = i; j < std::min(all.size(), i + 64 * kNodes); j += kNodes) some.push_back(all[j]);
      cells.add(some, queue, {});
    }
  });
  std::size_t num_pending = 0;
  for (LeafId leaf = 0; leaf < octree_.num_leaves(); ++leaf) {
    std::vector<CellId> taken = ids(cells.take(leaf));
    std::sort(taken.begin(), taken.end());
    EXPECT_EQ(taken, of_leaf_[leaf]) << "leaf " << leaf;
    num_pending += !taken.empty();
  }
  std::vector<CellId> left = ids(cells.take_leftover());
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, outside_);
  EXPECT_EQ(RefinementQueueState(queue).counts().pending, num_pending);
}

}  // namespace
}  // namespace podm::test
