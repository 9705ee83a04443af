#include "geometry/rank_boxes.h"

#include <gtest/gtest.h>

#include "ranks/ranks_in_process.h"

namespace podm::verify {
namespace {

Bounds box_at(double x) { return {{x, 0, 0}, {x + 1, 1, 1}}; }

TEST(RankBoxes, NameEachOtherRankWithABoxThatMeetsOnce) {
  run_ranks(4, [](Communication& ranks) {
    // Rank r has two boxes at 10 r and one that is far away; rank 3 has none.
    const double place = 10 * ranks.rank();
    const RankBoxes boxes(ranks, ranks.rank() == 3 ? std::vector<Bounds>{}
                                                   : std::vector<Bounds>{box_at(place), box_at(place + 2),
                                                                         box_at(place + 1000)});
    const auto others_near = [&](const Bounds& place_asked) {
      std::vector<std::size_t> found;
      boxes.for_each_other([&](const Bounds& box) { return meet(box, place_asked); },
                           [&](std::size_t rank) { found.push_back(rank); });
      std::sort(found.begin(), found.end());
      return found;
    };
    std::vector<std::size_t> others;
    for (std::size_t r = 0; r < 3; ++r)
      if (r != static_cast<std::size_t>(ranks.rank())) others.push_back(r);
    EXPECT_EQ(others_near({{0, 0, 0}, {23, 1, 1}}), others);
    EXPECT_TRUE(others_near({{100, 0, 0}, {900, 1, 1}}).empty()) << "between the boxes of each rank";
  });
}

TEST(BoxTree, HasBoxesAtALevelThatHoldAll) {
  std::vector<Bounds> all;
  for (int i = 0; i < 5000; ++i) all.push_back(box_at(i < 2500 ? i % 100 : 1e6 + i % 100));
  const BoxTree tree(all);
  EXPECT_TRUE(BoxTree({}).boxes_at(6).empty());
  EXPECT_EQ(tree.boxes_at(0).size(), 1U);
  const std::vector<Bounds> boxes = tree.boxes_at(6);
  EXPECT_EQ(boxes.size(), 64U);
  for (const Bounds& box : boxes) EXPECT_LT(box.high[0] - box.low[0], 101) << "holds the gap";
  for (const Bounds& box : all)
    EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Bounds& b) {
      return b.low[0] <= box.low[0] && box.high[0] <= b.high[0];
    }));
}

TEST(BoxTree, RangesOfItemsHaveBoxesThatHoldThem) {
  const auto box_of = [](std::size_t i) {
    return i % 2 == 1 ? kEmptyBounds : box_at(static_cast<double>(i));
  };
  for (const std::size_t count : {0, 1, 2, 63, 64, 1000}) {
    const std::vector<Bounds> boxes = boxes_of_ranges(count, box_of);
    EXPECT_LE(boxes.size(), kBoxesOfRank);
    for (std::size_t i = 0; i < count; i += 2)
      EXPECT_EQ(std::count_if(boxes.begin(), boxes.end(),
                              [&](const Bounds& b) {
                                const double low = static_cast<double>(i);
                                return b.low[0] <= low && low + 1 <= b.high[0];
                              }),
                1);
  }
}

}  // namespace
}  // namespace podm::verify
