// Lines that are found again from facets are those of a reference, in every order of the mesh.
#include <gtest/gtest.h>

#include "io/lines_of_facets.h"
#include "io/tests/kuhn_mesh.h"
#include "podm/mesh_io.h"

namespace podm {
namespace {

TEST(LinesOfFacets, AreAllEdgesWhereThreeLabelsMeet) {
  for (const int size : {3, 5, 8}) {
    TetMesh expected = make_test_mesh(size);
    add_lines(expected);
    ASSERT_FALSE(expected.lines.edges.empty());
    TetMesh found = shuffled(expected, 7);
    found.lines = lines_of_facets(found, expected.lines.delta_mm);
    canonicalize(expected);
    canonicalize(found);
    EXPECT_TRUE(same_mesh(found, expected)) << size;
    EXPECT_TRUE(found.lines.are_kept());
  }
}

TEST(LinesOfFacets, AMeshOfOneLabelHasNone) {
  const TetMesh mesh = make_kuhn_mesh(3, 1, [](int, int, int) { return LabelIndex{1}; });
  const MeshLines lines = lines_of_facets(mesh, 2);
  EXPECT_TRUE(lines.edges.empty());
  EXPECT_TRUE(lines.are_kept());
}

}  // namespace
}  // namespace podm
