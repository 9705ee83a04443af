#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <tuple>

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

// The mesh has enough vertices that several share a bucket of the radix pass.
TEST(CanonicalOrder, HoldsBeyondOneVertexABucket) {
  const TetMesh mesh = make_test_mesh(18, 5);
  ASSERT_GT(mesh.vertices.size(), 4096u);
  const TetMesh expected = canonical(mesh);
  EXPECT_TRUE(same_mesh(canonical(shuffled(mesh, 6)), expected));
  EXPECT_TRUE(std::is_sorted(expected.cells.begin(), expected.cells.end()));
}

// Returns the lexicographically first permutation of a simplex that keeps its orientation.
std::array<std::uint32_t, 4> first_way(const std::array<std::uint32_t, 4>& cell) {
  std::array<unsigned, 4> order{0, 1, 2, 3};
  std::array<std::uint32_t, 4> first = cell;
  do {
    int inversions = 0;
    for (unsigned i = 0; i < 4; ++i)
      for (unsigned j = 0; j < i; ++j) inversions += order[j] > order[i];
    if (inversions % 2 != 0) continue;
    first = std::min(first, {cell[order[0]], cell[order[1]], cell[order[2]], cell[order[3]]});
  } while (std::next_permutation(order.begin(), order.end()));
  return first;
}
std::array<std::uint32_t, 3> first_way(const std::array<std::uint32_t, 3>& facet) {
  const auto [a, b, c] = facet;
  return std::min({facet, {b, c, a}, {c, a, b}});
}

template <class Simplex, class SimplexLabel>
void sort_plainly(std::vector<Simplex>& simplices, std::vector<SimplexLabel>& labels,
                  const std::map<std::uint32_t, std::uint32_t>& position) {
  std::vector<std::pair<Simplex, SimplexLabel>> both;
  for (std::size_t i = 0; i < simplices.size(); ++i) {
    for (std::uint32_t& v : simplices[i]) v = position.at(v);
    both.emplace_back(first_way(simplices[i]), labels[i]);
  }
  std::sort(both.begin(), both.end());
  for (std::size_t i = 0; i < both.size(); ++i) std::tie(simplices[i], labels[i]) = both[i];
}

TetMesh sorted_plainly(TetMesh mesh) {
  std::vector<std::pair<std::array<double, 3>, std::uint32_t>> vertices;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) vertices.emplace_back(mesh.vertices[v], v);
  std::sort(vertices.begin(), vertices.end());
  std::map<std::uint32_t, std::uint32_t> position;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    mesh.vertices[v] = vertices[v].first;
    position[vertices[v].second] = v;
  }
  sort_plainly(mesh.cells, mesh.cell_labels, position);
  sort_plainly(mesh.facets, mesh.facet_labels, position);
  return mesh;
}

// The simplices have arbitrary vertices and repeat: some vertices have hundreds of simplices, others none.
// Many vertices share an x, one is far away.
TEST(CanonicalOrder, IsThatOfAPlainSort) {
  std::mt19937_64 random(3);
  TetMesh mesh;
  for (int i = 0; i < 3000; ++i)
    mesh.vertices.push_back({static_cast<double>(random() % 20) / 7, static_cast<double>(random()), i / 3.0});
  mesh.vertices.push_back({-1e200, 0, 0});
  const auto draw = [&] {
    return static_cast<std::uint32_t>(random() % 2 == 0 ? random() % 30 : random() % mesh.vertices.size());
  };
  for (int i = 0; i < 30000; ++i) {
    mesh.cells.push_back({draw(), draw(), draw(), draw()});
    mesh.cell_labels.push_back(static_cast<LabelIndex>(random()));
    mesh.facets.push_back({draw(), draw(), draw()});
    mesh.facet_labels.push_back({static_cast<LabelIndex>(random()), static_cast<LabelIndex>(random())});
  }
  mesh.cells.insert(mesh.cells.end(), mesh.cells.begin(), mesh.cells.begin() + 100);
  mesh.cell_labels.resize(mesh.cells.size(), 7);
  std::erase_if(mesh.cells, [](auto c) { return std::set(c.begin(), c.end()).size() < 4; });
  std::erase_if(mesh.facets, [](auto f) { return std::set(f.begin(), f.end()).size() < 3; });
  mesh.cell_labels.resize(mesh.cells.size());
  mesh.facet_labels.resize(mesh.facets.size());
  const TetMesh expected = sorted_plainly(mesh);
  for (const int threads : {1, 2, 7, 0}) {
    TetMesh sorted = mesh;
    canonicalize(sorted, threads);
    EXPECT_TRUE(sorted.vertices == expected.vertices) << threads;
    EXPECT_TRUE(sorted.cells == expected.cells && sorted.cell_labels == expected.cell_labels) << threads;
    EXPECT_TRUE(sorted.facets == expected.facets && sorted.facet_labels == expected.facet_labels) << threads;
  }
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
