#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

TEST(Delaunay, AcceptsRandomTriangulationsAndPartsOfThem) {
  std::mt19937 random(30);
  for (int round = 0; round < 20; ++round) {
    Mesh mesh = delaunay_by_force(random_points(10, random));
    const ClaimResult whole = delaunay_of(mesh);
    EXPECT_EQ(whole.verdict, Verdict::kPass) << whole.reason;
    EXPECT_EQ(whole.details()["cospherical_vertices"], 0);
    std::erase_if(mesh.cells, [&](auto&) { return random() % 2 == 0; });
    EXPECT_EQ(delaunay_of(mesh).verdict, Verdict::kPass);
  }
}

TEST(Delaunay, FindsExactlyTheVerticesInRandomBalls) {
  std::mt19937 random(31);
  for (int round = 0; round < 200; ++round) {
    const bool is_degenerate = round % 2 == 0;
    Mesh mesh = mesh_of(is_degenerate ? lattice_points(12, 3, random) : random_points(12, random), {});
    std::uniform_int_distribution<VertexId> vertex(0, 11);
    while (mesh.cells.size() < 6) {
      const std::array<VertexId, 4> v{vertex(random), vertex(random), vertex(random), vertex(random)};
      if (rational_orientation(mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]],
                               mesh.vertices[v[3]]) != 0)
        mesh.cells.push_back(v);
    }
    std::uint64_t num_inside = 0, num_on = 0;
    const auto used = used_vertices(mesh);
    for (const auto& v : mesh.cells)
      for (VertexId x = 0; x < 12; ++x) {
        if (!used[x] || std::find(v.begin(), v.end(), x) != v.end()) continue;
        const int side = rational_side_of_sphere(
            {mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]], mesh.vertices[v[3]]},
            mesh.vertices[x]);
        num_inside += side > 0;
        num_on += side == 0;
      }
    const ClaimResult result = delaunay_of(mesh);
    EXPECT_EQ(result.details()["global_violations"], num_inside);
    EXPECT_EQ(result.details()["cospherical_vertices"], num_on);
    EXPECT_EQ(result.verdict == Verdict::kPass, num_inside == 0);
  }
}

TEST(Delaunay, CountsTiesApart) {
  const Mesh cubes = kuhn_cubes(2);
  const ClaimResult tied = delaunay_of(cubes);
  EXPECT_EQ(tied.verdict, Verdict::kPass);
  EXPECT_GT(tied.details()["cospherical_facets"], 0);

  // Two cells on a sphere around the origin, except for the lower tip.
  const auto with_tip = [](double z) {
    const Mesh mesh = mesh_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, z}}, {});
    Mesh two = mesh;
    two.cells = {{1, 0, 2, 4}, {0, 1, 2, 3}};
    return delaunay_of(two);
  };
  EXPECT_EQ(with_tip(-1).details()["cospherical_facets"], 1);
  EXPECT_EQ(with_tip(-1).verdict, Verdict::kPass);
  EXPECT_EQ(with_tip(std::nextafter(-1, -2)).verdict, Verdict::kPass);
  EXPECT_EQ(with_tip(std::nextafter(-1, -2)).details()["cospherical_facets"], 0);
  EXPECT_EQ(with_tip(std::nextafter(-1, 0)).details()["local_violations"], 1);
}

TEST(Delaunay, FindsVerticesThatNoSharedFacetShows) {
  const Mesh cell = corner(1, 1, 1);
  EXPECT_EQ(delaunay_of(joined(cell, shifted(cell, {3, 0, 0}))).verdict, Verdict::kPass);
  const ClaimResult result = delaunay_of(joined(cell, shifted(cell, {0.9, 0.9, 0.9})));
  EXPECT_EQ(result.details()["local_violations"], 0);
  EXPECT_GT(result.details()["global_violations"], 0);
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(Delaunay, LeavesUnusedVerticesOut) {
  Mesh mesh = corner(1, 1, 1);
  mesh.vertices.push_back({0.5, 0.5, 0.5});
  EXPECT_EQ(delaunay_of(mesh).verdict, Verdict::kPass);
}

TEST(Delaunay, RejectsFlatCells) {
  EXPECT_TRUE(names(delaunay_of(two_cells({0.5, 0.5, 0})), "every cell has a circumsphere"));
  EXPECT_TRUE(
      names(delaunay_of(mesh_of(corner(1, 1, 1).vertices, {{0, 0, 0, 0}})), "every cell has a circumsphere"));
}

// A nearly flat cell has a huge ball, whose rounded center means nothing.
TEST(Delaunay, DecidesSliversAndExtremeScales) {
  for (const double scale : {1e-100, 1e-30, 1.0, 1e30, 1e90}) {
    const double thin = scale * 0x1p-50;
    const Mesh sliver =
        mesh_of({{0, 0, 0}, {scale, 0, 0}, {scale, scale, thin}, {0, scale, 0}}, {{0, 1, 3, 2}});
    const auto with_cell_at = [&](double z) {
      return delaunay_of(joined(sliver, shifted(corner(scale, scale, scale), {scale / 4, scale / 4, z})));
    };
    const auto count_inside = [&](const Mesh& mesh) {
      std::uint64_t count = 0;
      for (std::size_t c = 0; c < 2; ++c)
        for (std::size_t x = 0; x < 4; ++x) {
          const auto& p = mesh.vertices;
          count += rational_side_of_sphere({p[4 * c], p[4 * c + 1], p[4 * c + 2], p[4 * c + 3]},
                                           p[4 - 4 * c + x]) > 0;
        }
      return count;
    };
    for (const double z : {scale * 1e-3, -scale * 1e-3, -scale * 0x1p-60, scale * 0x1p-60, 3 * scale}) {
      const Mesh mesh = joined(sliver, shifted(corner(scale, scale, scale), {scale / 4, scale / 4, z}));
      EXPECT_EQ(with_cell_at(z).details()["global_violations"], count_inside(mesh)) << scale << " " << z;
    }
  }
}

TEST(Delaunay, DoesNotDependOnThreads) {
  std::mt19937 random(32);
  Mesh mesh = kuhn_cubes(4);
  for (Point& p : mesh.vertices) p[0] += 0.1 * static_cast<double>(random() % 4);
  const ClaimResult one = delaunay_of(mesh, 1);
  ASSERT_EQ(one.verdict, Verdict::kFail);
  for (const int threads : {2, 3, 7}) {
    const ClaimResult many = delaunay_of(mesh, threads);
    EXPECT_EQ(many.details(), one.details());
    EXPECT_EQ(many.bad_cells, one.bad_cells);
    ASSERT_EQ(many.worst.size(), one.worst.size());
    for (std::size_t w = 0; w < one.worst.size(); ++w)
      EXPECT_EQ(many.worst[w].vertices, one.worst[w].vertices);
  }
}

}  // namespace
}  // namespace podm::verify
