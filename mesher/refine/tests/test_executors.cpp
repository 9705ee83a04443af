// What executors and leaves do with gifts of no cells, as a leaf's cells may be taken with those that came to
// it late, and when a stop is requested.
#include <gtest/gtest.h>

#include <set>

#include "cost_model.h"
#include "images.h"
#include "podm.h"
#include "refine/leaf_refinement.h"
#include "refine/thread_executor.h"
#include "refine/virtual_box.h"
#include "refine/virtual_executor.h"

namespace podm::test {
namespace {

using Entries = CellSource::Entries;

// Empty gifts, the cells, empty gifts, and no more.
class StingySource : public CellSource {
 public:
  explicit StingySource(Entries cells) : cells_(std::move(cells)) {}
  std::optional<Entries> next(bool) override {
    ++calls_;
    if (calls_ == kEmptyGifts) return cells_;
    if (calls_ < 2 * kEmptyGifts) return Entries{};
    return std::nullopt;
  }

 private:
  static constexpr int kEmptyGifts = 50;
  Entries cells_;
  int calls_ = 0;
};

// Workers who begin with nothing and refine a ball.
class EmptyGifts : public testing::TestWithParam<int> {
 protected:
  EmptyGifts() : mesh_(virtual_box(clamp_), 1 << 20) {
    for (WorkerId id = 0; id < static_cast<WorkerId>(GetParam()); ++id) {
      pools_.push_back(std::make_unique<Pool>(mesh_));
      workers_.push_back(
          std::make_unique<Worker<VertexLocks>>(mesh_, isosurface_, parameters_, id, *pools_[id]));
    }
  }
  Entries first_cells() const {
    Entries cells;
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) cells.push_back({c, mesh_.stamp(c)});
    return cells;
  }
  CoordinationOptions options() const { return {GetParam(), Contention::kLocal, {}, 3}; }
  void expect_refined() const {
    std::string fault;
    EXPECT_TRUE(is_valid(mesh_, &fault)) << fault;
    EXPECT_GT(mesh_.num_cells(), 1000u);
    for (const auto& worker : workers_) EXPECT_FALSE(worker->has_work());
  }

  LabelImage image_ = ball(16, 6);
  Isosurface isosurface_{image_, 1};
  Box clamp_ = clamp_box(foreground_bounds(image_), 1.2);
  Problem problem_{isosurface_, foreground_bounds(image_), 1.2, SizeField(std::vector<double>(2, 1.6)),
                   1 << 20};
  Parameters parameters_ = parameters_for(problem_, 1, clamp_);
  Mesh mesh_;
  std::vector<std::unique_ptr<Pool>> pools_;
  std::vector<std::unique_ptr<Worker<VertexLocks>>> workers_;
  Watch watch_{{}, {}, [](std::uint64_t) {}};
};

TEST_P(EmptyGifts, AreBeggedAgainOnThreads) {
  StingySource source(first_cells());
  ThreadExecutor<VertexLocks> executor(watch_, options(), {});
  EXPECT_EQ(executor.run(workers_, &source), StopReason::kComplete);
  expect_refined();
}

TEST_P(EmptyGifts, AreBeggedAgainInVirtualTime) {
  StingySource source(first_cells());
  VirtualExecutor<VertexLocks> executor(watch_, options(), VirtualCost::kUnit);
  EXPECT_EQ(executor.run(workers_, {&source}), StopReason::kComplete);
  expect_refined();
}

INSTANTIATE_TEST_SUITE_P(Workers, EmptyGifts, testing::Values(1, 3));

Octree one_leaf(const Box& box) {
  const double side_mm = box.high.x - box.low.x;
  return {box.low, box.high, side_mm, [=](const Point&, const Point&) { return side_mm; },
          [](const Point&, const Point&) { return true; }};
}

// Another node lists a cell of a leaf between the moments when its number and its cells are taken: the cell
// goes with the others, and the leaf is handed out once more, with none.
TEST(LeafRefinement, CellsThatComeLateAreTakenOnce) {
  const Box box{{0, 0, 0}, {8, 8, 8}};
  Mesh mesh(box, 1 << 10);
  const Octree octree = one_leaf(box);
  const Entries early{{0, mesh.stamp(0)}, {1, mesh.stamp(1)}}, late{{2, mesh.stamp(2)}};
  LeafRefinement leaves(mesh, octree, 2, early, [] { return 0.0; }, {});
  const auto leaf = leaves.take_leaf(0, false);
  ASSERT_TRUE(leaf);
  leaves.add(late);
  std::multiset<CellId> taken;
  for (const auto& entry : leaves.take_cells(*leaf)) taken.insert(entry.cell);
  leaves.finish({*leaf, 0, 0, 0, 0, 0, {}});
  const auto again = leaves.take_leaf(1, false);
  ASSERT_TRUE(again);
  for (const auto& entry : leaves.take_cells(*again)) taken.insert(entry.cell);
  leaves.finish({*again, 1, 0, 0, 0, 0, {}});
  EXPECT_EQ(taken, (std::multiset<CellId>{0, 1, 2}));
  EXPECT_FALSE(leaves.take_leaf(0, true)) << "nothing is left to wait for";
}

// The making of leaves asks for no reasons, and looks at this.
TEST(Watch, IsOverAsSoonAsAStopIsRequested) {
  std::stop_source stop;
  Watch watch({}, stop.get_token(), [](std::uint64_t) {});
  EXPECT_FALSE(watch.over().stop_requested());
  EXPECT_EQ(watch.reason(), StopReason::kComplete);
  stop.request_stop();
  EXPECT_TRUE(watch.over().stop_requested());
  EXPECT_EQ(watch.reason(), StopReason::kCancelled);
}

TEST(LeafRefinement, ListsNothingWhenTheRunIsOver) {
  const Box box{{0, 0, 0}, {8, 8, 8}};
  Mesh mesh(box, 1 << 10);
  const Octree octree = one_leaf(box);
  std::stop_source over;
  over.request_stop();
  LeafRefinement leaves(
      mesh, octree, 2, {{0, mesh.stamp(0)}}, [] { return 0.0; }, over.get_token());
  EXPECT_FALSE(leaves.take_leaf(0, true));
  EXPECT_TRUE(leaves.take_cells(0).empty());
}

}  // namespace
}  // namespace podm::test
