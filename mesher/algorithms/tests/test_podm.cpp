// PODM's loop on a group whose master calls it repeatedly, like leaf after leaf, sometimes without any cells:
// other nodes may have taken a leaf's cells with its last ones.
#include <gtest/gtest.h>

#include "algorithms/podm.h"
#include "delaunay/tests/validity.h"
#include "image/foreground.h"
#include "refine/virtual_box.h"
#include "tests/images.h"

namespace podm::test {
namespace {

class Group : public testing::TestWithParam<int> {
 protected:
  template <class Time>
  void refine_a_ball(Time& time) {
    constexpr int kEmptyLeaves = 50;
    Construction construction(problem_, clamp_, team_, stop_);
    auto workers = construction.make_workers<VertexLocks>(parameters_, GetParam());
    Coordination group(team_.coordination, [&](WorkerId worker) { time.resume(worker); });
    time.run([&](WorkerId self) {
      if (self != 0) {
        EXPECT_TRUE(refine(*workers[self], group, time));
        return;
      }
      for (int leaf = 0; leaf < 2 * kEmptyLeaves; ++leaf) {
        if (leaf == kEmptyLeaves) workers[0]->give(construction.all_cells());
        EXPECT_TRUE(refine(*workers[0], group, time));
        for (const auto& worker : workers) EXPECT_FALSE(worker->has_work());
      }
      group.dismiss();
    });
    std::string fault;
    EXPECT_TRUE(is_valid(construction.mesh(), &fault)) << fault;
    EXPECT_GT(construction.mesh().num_cells(), 1000u);
    EXPECT_FALSE(stop_.is_over());
  }

  LabelImage image_ = ball(16, 6);
  Isosurface isosurface_{image_, 1};
  Box clamp_ = clamp_box(foreground_bounds(image_), 1.2);
  Problem problem_{.isosurface = isosurface_,
                   .object = foreground_bounds(image_),
                   .delta_mm = 1.2,
                   .sizes = SizeField(std::vector<double>(2, 1.6)),
                   .cell_capacity = 1 << 20};
  Parameters parameters_ = parameters_for(problem_, 1, clamp_);
  Team team_{.coordination = {.num_workers = GetParam(), .seed = 3}};
  StopControl stop_{{}, {}, [](std::uint64_t) {}};
};

TEST_P(Group, RefinesWhatItsMasterIsGivenOnThreads) {
  RealTime time(stop_, static_cast<std::size_t>(GetParam()), {});
  refine_a_ball(time);
}

TEST_P(Group, RefinesWhatItsMasterIsGivenInVirtualTime) {
  VirtualTime time(stop_, static_cast<std::size_t>(GetParam()), VirtualCost::kUnit, 3);
  refine_a_ball(time);
}

INSTANTIATE_TEST_SUITE_P(Workers, Group, testing::Values(1, 3, 8));

}  // namespace
}  // namespace podm::test
