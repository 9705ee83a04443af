// All ranks compute the same seeds, and seeds cover the object.
#include "distributed/lattice_seeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "delaunay/tests/triangulator.h"
#include "distributed/seeding.h"
#include "image/foreground.h"
#include "refine/virtual_box.h"
#include "tests/images.h"

namespace podm::test {
namespace {

struct SeededCase {
  std::string name;
  LabelImage image;
  std::vector<double> radii_mm;  // by label
};

class Seeds : public testing::TestWithParam<SeededCase> {
 protected:
  static std::vector<Point> sorted(std::vector<Point> points) {
    std::sort(points.begin(), points.end(), lexicographically_less);
    return points;
  }
  CubeSet all_cubes() const {
    CubeSet all(grid_);
    all.insert_all();
    return all;
  }

  const LabelImage& image_ = GetParam().image;
  const Isosurface isosurface_{image_, 1};
  const Problem problem_{.isosurface = isosurface_,
                         .object = foreground_bounds(image_),
                         .delta_mm = 0.7,
                         .sizes = SizeField(GetParam().radii_mm),
                         .cell_capacity = 1 << 20};
  const Box clamp_ = grown(problem_.object, 6);
  const CubeGrid grid_{problem_.object, 2};
  const LatticeSeeds seeds_{problem_, box_of_seeds(clamp_), 1};
  const std::vector<Point> all_ = seeds_.in(all_cubes());
};

TEST_P(Seeds, OfPartsAreThoseOfTheWhole) {
  std::mt19937_64 random(1);
  ASSERT_GT(all_.size(), 40u);
  for (int round = 0; round < 5; ++round) {
    std::vector<CubeSet> parts(3, CubeSet(grid_));
    for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube) parts[random() % 3].insert(cube);
    std::vector<Point> joined;
    for (const CubeSet& part : parts) {
      const std::vector<Point> some = LatticeSeeds(problem_, box_of_seeds(clamp_), 1 + random() % 3).in(part);
      for (const Point& p : some) EXPECT_TRUE(part.has(p));
      joined.insert(joined.end(), some.begin(), some.end());
    }
    EXPECT_EQ(sorted(joined), sorted(all_));
  }
}

TEST_P(Seeds, AreSparserFarAwayButNoOthers) {
  const Point low = problem_.object.low;
  const Box box{low, low + Vector{2, 2, 2}};
  const std::vector<Point> sparse = seeds_.sparse_around(box);
  EXPECT_GT(sparse.size(), 30u);
  EXPECT_LT(sparse.size(), all_.size());
  const std::vector<Point> known = sorted(all_);
  for (const Point& p : sparse)
    EXPECT_TRUE(std::binary_search(known.begin(), known.end(), p, lexicographically_less));
}

TEST_P(Seeds, KeepTheSpacingOfI3) {
  // Each of two seeds is moved by up to 0.01 of the side along each axis.
  const double least_mm = 0.999 * std::sqrt(3) * (0.5 - 2 * 0.01) * 3 * radii_of(problem_).least;
  EXPECT_GT(least_mm,
            kRadiusEdgeBound * std::min(problem_.delta_mm, radii_of(problem_).least / kRadiusEdgeBound));
  for (std::size_t i = 0; i < all_.size(); ++i)
    for (std::size_t k = i + 1; k < all_.size(); ++k) ASSERT_GT(distance(all_[i], all_[k]), least_mm);
}

// The proof in lattice_seeds.h: sqrt(5)/4 of the largest side that is allowed at the center.
TEST_P(Seeds, LeaveNoLargerBallThanTheyAreProvedToLeave) {
  Triangulator triangulator(virtual_box(clamp_));
  for (const Point& p : all_) triangulator.insert(p);
  const Mesh& mesh = triangulator.mesh;
  const double most_mm = 3 * *std::max_element(GetParam().radii_mm.begin() + 1, GetParam().radii_mm.end());
  int num_inside = 0;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    const Cell& cell = mesh.cell(c);
    if (!cell.is_alive() || isosurface_.label_at(cell.center) == kBackground) continue;
    const double radius = distance(cell.center, mesh.point(cell.vertices[0]));
    EXPECT_LE(radius, std::sqrt(5) / 4 * most_mm + 0.1);
    ++num_inside;
  }
  EXPECT_GT(num_inside, 20);
}

TEST_P(Seeds, OfARankAreThoseOfTheWholeWhereTheyAreKnown) {
  const Team team;
  StopControl stop({}, {}, [](std::uint64_t) {});
  Construction construction(problem_, clamp_, team, stop);
  Learner learner(construction, grid_);
  CubeSet block(grid_);
  block.insert(CubeId{0});
  Seeding seeding(seeds_, learner, block);
  CubeSet wanted = block.grown(2);
  EXPECT_FALSE(seeding.known().has(CubeId{0}));
  seeding.update(wanted);
  EXPECT_EQ(seeding.update(wanted).cubes, 0u);
  std::vector<Point> found;
  const Mesh& mesh = construction.mesh();
  for (VertexId v = 0; v < mesh.vertex_bound(); ++v)
    if (mesh.vertex(v).kind == VertexKind::kCircumcenter && wanted.has(mesh.point(v)))
      found.push_back(mesh.point(v));
  EXPECT_EQ(sorted(found), sorted(seeds_.in(wanted)));
  EXPECT_EQ(seeding.known().cubes(), wanted.cubes());
}

std::vector<SeededCase> seeded_cases() {
  const auto two_labels = make_image({24, 24, 24}, {1, 1, 1}, 2, [](int i, int j, int k) {
    return std::hypot(i - 11.5, j - 11.5, k - 11.5) >= 10 ? 0 : k < 12 ? 1 : 2;
  });

  return {{"one_radius", ball(24, 9), {1, 1}},
          {"two_radii", two_labels, {1, 1, 2.5}},
          {"off_by_a_third", two_labels, {1, 1.3, 1}},
          {"thin_voxels", image_named("anisotropic_ball"), {1, 1}}};
}

INSTANTIATE_TEST_SUITE_P(Images, Seeds, testing::ValuesIn(seeded_cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace podm::test
