// The work predicted by cube adds up to the work predicted from the image, on any number of ranks.
#include "distributed/predicted_work.h"

#include <gtest/gtest.h>

#include <numeric>

#include "distributed/in_process_ranks.h"
#include "image/foreground.h"
#include "prediction/cost_model.h"
#include "tests/images.h"

namespace podm::test {
namespace {

// Returns the work of all cubes.
std::vector<std::uint32_t> work_on(int num_ranks, const Problem& problem, const CubeGrid& grid) {
  std::vector<CubeWork> work(static_cast<std::size_t>(num_ranks));
  run_ranks({.num_ranks = num_ranks, .one_at_a_time = true}, [&](Communication& ranks) {
    const auto rank = static_cast<std::size_t>(ranks.rank());
    work[rank] = predicted_work(problem, grid, 1 + rank % 2, ranks);
  });
  std::vector<std::uint32_t> all;
  for (const CubeWork& of_rank : work) {
    EXPECT_EQ(of_rank.first, all.size());
    all.insert(all.end(), of_rank.of_cube.begin(), of_rank.of_cube.end());
  }
  return all;
}

TEST(PredictedWork, IsTheSameOnAnyNumberOfRanksAndNearThatOfTheWhole) {
  for (const char* name : {"ball", "three_labels_meeting", "anisotropic_ball"}) {
    const LabelImage image = image_named(name);
    const Isosurface isosurface(image, 1);
    const Problem problem{.isosurface = isosurface,
                          .object = foreground_bounds(image),
                          .delta_mm = 0.7,
                          .sizes = SizeField(std::vector<double>(image.labels.size(), 1.0)),
                          .cell_capacity = 1 << 20};
    const CubeGrid grid(problem.object, 2);
    const std::vector<std::uint32_t> work = work_on(1, problem, grid);
    EXPECT_EQ(work.size(), grid.num_cubes());
    for (const int num_ranks : {2, 3, 7}) EXPECT_EQ(work_on(num_ranks, problem, grid), work);
    SizeOptions sizes;
    sizes.radius_mm = 1;
    sizes.delta_mm = problem.delta_mm;
    const CostModel model(image, 1);
    const double sum =
        1e-3 * static_cast<double>(std::accumulate(work.begin(), work.end(), std::uint64_t{0}));
    EXPECT_NEAR(sum / (model.cells(sizes) + kWorkPerSquare * model.squares(sizes)), 1, 0.5) << name;
  }
}

}  // namespace
}  // namespace podm::test
