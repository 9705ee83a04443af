#include <gtest/gtest.h>

#include <algorithm>

#include "io/tests/kuhn_mesh.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

TetMesh canonical(TetMesh mesh) {
  canonicalize(mesh);
  return mesh;
}

TEST(CanonicalOrder, DoesNotDependOnTheOrderOfTheInput) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const TetMesh mesh = make_test_mesh(3 + static_cast<int>(seed % 5), seed);
    const TetMesh expected = canonical(mesh);
    for (std::uint64_t shuffle = 0; shuffle < 3; ++shuffle)
      EXPECT_TRUE(same_mesh(canonical(shuffled(mesh, 100 * seed + shuffle)), expected)) << "seed " << seed;
  }
}

// Enough vertices for several to share a bucket of the radix pass.
TEST(CanonicalOrder, HoldsBeyondOneVertexABucket) {
  const TetMesh mesh = make_test_mesh(18, 5);
  ASSERT_GT(mesh.vertices.size(), 4096u);
  const TetMesh expected = canonical(mesh);
  EXPECT_TRUE(same_mesh(canonical(shuffled(mesh, 6)), expected));
  EXPECT_TRUE(std::is_sorted(expected.cells.begin(), expected.cells.end()));
}

TEST(CanonicalOrder, IsSortedAndStartsAtTheSmallestVertex) {
  const TetMesh mesh = canonical(shuffled(make_test_mesh(), 3));
  EXPECT_TRUE(std::is_sorted(mesh.vertices.begin(), mesh.vertices.end()));
  EXPECT_TRUE(std::is_sorted(mesh.cells.begin(), mesh.cells.end()));
  EXPECT_TRUE(std::is_sorted(mesh.facets.begin(), mesh.facets.end()));
  for (const auto& [a, b, c, d] : mesh.cells) {
    EXPECT_LT(a, b);
    EXPECT_LT(b, std::min(c, d));
  }
  for (const auto& [a, b, c] : mesh.facets) EXPECT_LT(a, std::min(b, c));
}

TEST(CanonicalOrder, KeepsGeometryLabelsAndOrientation) {
  const TetMesh before = shuffled(make_test_mesh(), 4);
  const TetMesh after = canonical(before);
  ASSERT_EQ(after.cells.size(), before.cells.size());
  ASSERT_EQ(after.facets.size(), before.facets.size());
  const auto& v = after.vertices;
  for (const auto& [a, b, c, d] : after.cells) EXPECT_GT(six_volumes(v[a], v[b], v[c], v[d]), 0);
  for (LabelIndex label = 1; label < after.labels.size(); ++label)
    EXPECT_NEAR(volume_of_label(after, label), volume_of_label(before, label), 1e-9);

  const auto facets_by_coordinates = [](const TetMesh& mesh) {
    std::vector<std::pair<std::array<std::array<double, 3>, 3>, std::array<LabelIndex, 2>>> facets;
    for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
      const auto [a, b, c] = mesh.facets[i];
      std::array<std::array<double, 3>, 3> points{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
      std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
      facets.push_back({points, mesh.facet_labels[i]});
    }
    std::sort(facets.begin(), facets.end());
    return facets;
  };
  EXPECT_EQ(facets_by_coordinates(after), facets_by_coordinates(before));
}

TEST(CanonicalOrder, NegativeZeroIsZero) {
  TetMesh mesh;
  mesh.labels = {{0, ""}, {1, ""}};
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.cells = {{0, 1, 2, 3}};
  mesh.cell_labels = {1};
  TetMesh negative = mesh;
  for (auto& vertex : negative.vertices)
    for (double& c : vertex)
      if (c == 0) c = -0.0;
  EXPECT_EQ(mesh_sha256(canonical(mesh)), mesh_sha256(canonical(negative)));
}

TEST(CanonicalOrder, TakesAnEmptyMeshAndRefusesNan) {
  TetMesh mesh;
  canonicalize(mesh);
  EXPECT_TRUE(mesh.cells.empty());
  mesh.vertices.push_back({0, std::numeric_limits<double>::quiet_NaN(), 0});
  EXPECT_THROW(canonicalize(mesh), InternalError);
}

}  // namespace
}  // namespace podm
