// The order-independent hash is the same for the same mesh in any order and in any pieces, and differs after
// any change.
#include <gtest/gtest.h>

#include <cmath>

#include "io/tests/kuhn_mesh.h"
#include "io/tests/split_mesh.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

TEST(MeshHash, IgnoresOrderNamesAndTheNumberingOfLabels) {
  const TetMesh mesh = make_test_mesh();
  TetMesh other = shuffled(mesh, 9);
  other.labels[1].name = "hepar";
  EXPECT_EQ(mesh_hash(other), mesh_hash(mesh));
  canonicalize(other);
  EXPECT_EQ(mesh_hash(other, 2), mesh_hash(mesh, 1));
  other.labels.push_back(other.labels[3]);  // the same value at another index
  for (LabelIndex& label : other.cell_labels)
    if (label == 3) label = 4;
  EXPECT_EQ(mesh_hash(other), mesh_hash(mesh));
}

TEST(MeshHash, AddsUpOverPieces) {
  const TetMesh mesh = make_test_mesh();
  for (const int num_pieces : {1, 2, 5}) {
    std::uint64_t sum = 0;
    for (const MeshPiece& piece : split_into_pieces(mesh, num_pieces)) sum += mesh_hash(piece.mesh);
    EXPECT_EQ(sum, mesh_hash(mesh)) << num_pieces;
  }
}

TEST(MeshHash, SeesEveryChange) {
  const TetMesh mesh = make_test_mesh();
  const std::uint64_t hash = mesh_hash(mesh);
  const auto hash_after = [&mesh](const auto& change) {
    TetMesh changed = mesh;
    change(changed);
    return mesh_hash(changed);
  };
  const std::size_t v = mesh.cells[0][1], c = mesh.cells.size() - 1, f = mesh.facets.size() / 3;
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.vertices[v][2] = std::nextafter(m.vertices[v][2], 1e9); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.cell_labels[c] = m.cell_labels[c] == 1 ? 2 : 1; }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.labels[3].value = 4; }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { std::swap(m.cells[c][2], m.cells[c][3]); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { std::swap(m.facets[f][1], m.facets[f][2]); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { std::swap(m.facet_labels[f][0], m.facet_labels[f][1]); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) { m.cells.pop_back(), m.cell_labels.pop_back(); }));
  EXPECT_NE(hash, hash_after([&](TetMesh& m) {
              m.cells.push_back(m.cells[c]), m.cell_labels.push_back(m.cell_labels[c]);
            }));
}

}  // namespace
}  // namespace podm
