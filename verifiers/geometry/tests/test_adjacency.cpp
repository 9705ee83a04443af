#include <gtest/gtest.h>

#include <set>

#include "claims/tests/small_meshes.h"
#include "geometry/box_tree.h"

namespace podm::verify {
namespace {

TEST(Adjacency, IsThatOfAMapOfFacets) {
  std::mt19937 random(10);
  for (int round = 0; round < 30; ++round) {
    Mesh mesh = mesh_of(std::vector<Point>(12), {});
    std::uniform_int_distribution<VertexId> vertex(0, 11);
    for (int c = 0; c < 40; ++c)
      mesh.cells.push_back({vertex(random), vertex(random), vertex(random), vertex(random)});
    const Adjacency expected = mapped_adjacency(mesh);
    const std::set<std::vector<FacetId>> expected_crowds(expected.crowded.begin(), expected.crowded.end());
    for (const int threads : {1, 2, 5}) {
      const Adjacency found = find_adjacency(mesh, threads);
      EXPECT_EQ(found.mirror, expected.mirror);
      EXPECT_EQ(std::set(found.crowded.begin(), found.crowded.end()), expected_crowds);
      EXPECT_EQ(found.crowded, find_adjacency(mesh, 1).crowded);
    }
  }
}

TEST(Adjacency, FacetsTurnTheSameWaySeenFromTheirCells) {
  const Mesh mesh = corner(1, 1, 1);
  for (FacetId f = 0; f < 4; ++f) {
    const auto v = vertices_of(mesh, f);
    EXPECT_GT(rational_orientation(mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]],
                                   mesh.vertices[far_vertex(mesh, f)]),
              0);
  }
}

// Returns boxes of very different sizes and places, some of them equal.
std::vector<Bounds> graded_boxes(std::size_t count, std::mt19937& random) {
  std::vector<Bounds> boxes;
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t i = 0; i < count; ++i) {
    const double scale = std::pow(10, -8 * unit(random));
    Bounds box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = scale * unit(random);
      box.high[a] = box.low[a] + (i % 3 == 0 ? 0 : scale * unit(random));
    }
    boxes.push_back(i % 7 == 0 && i > 0 ? boxes.back() : box);
  }
  return boxes;
}

TEST(BoxTree, MissesNoneAndVisitsNoneTwice) {
  std::mt19937 random(11);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{17}, std::size_t{3000}}) {
    const auto boxes = graded_boxes(count, random);
    const BoxTree tree(boxes);
    for (const Bounds& asked : graded_boxes(200, random)) {
      std::vector<int> visits(count, 0);
      tree.for_each_near([&](const Bounds& box) { return meet(asked, box); },
                         [&](std::uint32_t i) { ++visits[i]; });
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_LE(visits[i], 1);
        if (meet(asked, boxes[i])) {
          EXPECT_EQ(visits[i], 1);
        }
      }
    }
  }
}

TEST(BoxTree, LeavesOutWhatIsFarAway) {
  std::mt19937 random(12);
  const auto boxes = graded_boxes(3000, random);
  const BoxTree tree(boxes);
  std::size_t num_visits = 0;
  for (const Bounds& box : boxes)
    tree.for_each_near(
        [&](const Bounds& other) {
          return meet({box.low, box.low}, other);
        },
        [&](std::uint32_t) { ++num_visits; });
  EXPECT_LT(num_visits, boxes.size() * boxes.size() / 10);
}

}  // namespace
}  // namespace podm::verify
