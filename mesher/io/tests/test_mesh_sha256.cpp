#include <gtest/gtest.h>
#include <openssl/sha.h>

#include <cmath>

#include "io/tests/kuhn_mesh.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

TetMesh canonical_test_mesh() {
  TetMesh mesh = make_test_mesh();
  canonicalize(mesh);
  return mesh;
}

TEST(MeshSha256, IsThatOfTheDocumentedBytes) {
  const TetMesh mesh = canonical_test_mesh();
  std::string bytes;
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const std::size_t count : {mesh.vertices.size(), mesh.cells.size(), mesh.facets.size()})
    append(std::uint64_t{count});
  for (const auto& vertex : mesh.vertices) append(vertex);
  for (const auto& cell : mesh.cells) append(cell);
  for (const LabelIndex label : mesh.cell_labels) append(mesh.labels[label].value);
  for (const auto& facet : mesh.facets) append(facet);
  for (const auto& pair : mesh.facet_labels)
    for (const LabelIndex label : pair) append(mesh.labels[label].value);

  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest);
  std::string expected;
  for (const unsigned char byte : digest) {
    expected += "0123456789abcdef"[byte >> 4];
    expected += "0123456789abcdef"[byte & 15];
  }
  EXPECT_EQ(mesh_sha256(mesh), expected);
}

TEST(MeshSha256, IgnoresOrderNamesAndTheNumberingOfLabels) {
  const TetMesh mesh = canonical_test_mesh();
  TetMesh other = shuffled(mesh, 9);
  canonicalize(other);
  other.labels[1].name = "hepar";
  EXPECT_EQ(mesh_sha256(other), mesh_sha256(mesh));

  other.labels.push_back(other.labels[3]);  // the same value at another index
  for (LabelIndex& label : other.cell_labels)
    if (label == 3) label = 4;
  EXPECT_EQ(mesh_sha256(other), mesh_sha256(mesh));
}

TEST(MeshSha256, SeesEveryChange) {
  const TetMesh mesh = canonical_test_mesh();
  const std::string hash = mesh_sha256(mesh);
  const auto hash_after = [&mesh](const auto& change) {
    TetMesh changed = mesh;
    change(changed);
    return mesh_sha256(changed);
  };
  const std::size_t v = mesh.vertices.size() / 2, c = mesh.cells.size() - 1, f = mesh.facets.size() / 3;
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.vertices[v][2] = std::nextafter(m.vertices[v][2], 1e9); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.cell_labels[c] = m.cell_labels[c] == 1 ? 2 : 1; }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.labels[3].value = 4; }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { std::swap(m.cells[c][2], m.cells[c][3]); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { std::swap(m.facets[f][1], m.facets[f][2]); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { std::swap(m.facet_labels[f][0], m.facet_labels[f][1]); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.cells.pop_back(), m.cell_labels.pop_back(); }));
}

TEST(MeshSha256, OfAnEmptyMeshIsThatOfThreeZeroCounts) {
  EXPECT_EQ(mesh_sha256(TetMesh{}), "9d908ecfb6b256def8b49a7c504e6c889c4b0e41fe6ce3e01863dd7b61a20aa0");
}

}  // namespace
}  // namespace podm
