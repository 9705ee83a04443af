// The label of a mesh at a place on facets does not depend on the way to it.
#include "topology/labels_at_places.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "delaunay/tests/point_sets.h"
#include "delaunay/tests/triangulator.h"

namespace podm {
namespace {

// Cells of a grid of points have random labels, and the places are the vertices.
TEST(LabelsAtPlaces, AreTheLeastOnesAroundWhateverTheWay) {
  std::mt19937_64 random(5);
  test::Triangulator triangulator(test::kBox);
  for (const Point& p : test::grid(5)) triangulator.insert(p);
  Mesh& mesh = triangulator.mesh;
  LabelImage image;
  image.voxel_to_ras = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  image.spacing = {1, 1, 1};
  image.labels = {{0, ""}, {7, ""}, {3, ""}, {5, ""}};
  for (CellId c = 0; c < mesh.cell_bound(); ++c) mesh.label(c) = static_cast<LabelIndex>(random() % 4);
  const auto least_around = [&](VertexId v) {
    LabelIndex least = kBackground;
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      const auto& vertices = mesh.cell(c).vertices;
      if (!mesh.cell(c).is_alive() || std::ranges::find(vertices, v) == vertices.end()) continue;
      const LabelIndex label = mesh.label(c);
      if (label == kBackground) continue;
      if (least == kBackground || image.labels[label].value < image.labels[least].value) least = label;
    }
    return least;
  };
  std::set<VertexId> used;
  for (CellId c = 0; c < mesh.cell_bound(); ++c)
    if (mesh.cell(c).is_alive()) used.insert(mesh.cell(c).vertices.begin(), mesh.cell(c).vertices.end());
  std::vector<VertexId> order(used.begin(), used.end());
  for (int round = 0; round < 4; ++round) {
    LabelsAtPlaces label_at(mesh, image);
    for (const VertexId v : order) EXPECT_EQ(label_at(mesh.point(v)), least_around(v));
    std::ranges::shuffle(order, random);
  }
}

}  // namespace
}  // namespace podm
