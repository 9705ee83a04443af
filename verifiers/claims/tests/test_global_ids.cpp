// Tests that claims name cells and vertices by their ids in the whole mesh, also beyond 32 bits.
#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "claims/tests/small_meshes.h"
#include "ranks/part.h"

namespace podm::verify {
namespace {

constexpr GlobalId kFirstCell = (GlobalId{1} << 33) + 5, kFirstVertex = (GlobalId{1} << 34) + 7;

// Makes the mesh the last part of a larger one, whose other cells and vertices do not touch it.
Mesh as_last_part(Mesh mesh, Communication& ranks) {
  Part part;
  part.ranks = &ranks;
  part.num_vertices = kFirstVertex + mesh.vertices.size();
  part.first_cells = {kFirstCell, kFirstCell + mesh.cells.size()};
  part.has_cell_labels = !mesh.cell_labels.empty();
  part.own_cells = {0, mesh.cells.size()};
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) part.vertices.push_back(kFirstVertex + v);
  part.is_own_vertex.assign(mesh.vertices.size(), 1);
  mesh.part = std::make_shared<const Part>(std::move(part));
  return mesh;
}

std::map<std::string, ClaimResult> results_of(const Mesh& mesh) {
  const Adjacency adjacency = find_adjacency(mesh, 2);
  Options options = two_threads();
  options.radius_mm = 0.1;
  options.min_dihedral_deg = 80;
  return {{"structure", check_structure(mesh, adjacency, options)},
          {"radius_edge", check_radius_edge(mesh, adjacency, options)},
          {"boundary_angles", check_boundary_angles(mesh, adjacency, options)},
          {"size", check_size(mesh, nullptr, nullptr, options)},
          {"dihedral", check_dihedral(mesh, options)},
          {"delaunay", check_delaunay(mesh, adjacency, options)},
          {"conformity", check_conformity(mesh, adjacency, nullptr, options)},
          {"surface", check_surface(mesh, adjacency, nullptr, options)}};
}

TEST(GlobalIds, AreThoseOfTheWholeMesh) {
  Mesh faulty = joined(kuhn_cubes(2), shifted(two_cells({0.25, 0.25, 0.5}), {0.3, 0.3, 0.3}));
  faulty.cell_labels.clear();
  faulty.cells.push_back(faulty.cells[3]);
  SingleRank ranks;
  const auto far = results_of(as_last_part(faulty, ranks));
  for (const auto& [claim, expected] : results_of(faulty)) {
    const ClaimResult& found = far.at(claim);
    EXPECT_EQ(found.verdict, expected.verdict) << claim;
    EXPECT_EQ(found.num_checked, expected.num_checked) << claim;
    EXPECT_EQ(found.num_violations, expected.num_violations) << claim;
    ASSERT_EQ(found.bad_cells.size(), expected.bad_cells.size()) << claim;
    for (std::size_t i = 0; i < found.bad_cells.size(); ++i)
      EXPECT_EQ(found.bad_cells[i], kFirstCell + expected.bad_cells[i]) << claim;
    ASSERT_EQ(found.worst.size(), expected.worst.size()) << claim;
    for (std::size_t i = 0; i < found.worst.size(); ++i) {
      std::vector<GlobalId> cells = expected.worst[i].cells, vertices = expected.worst[i].vertices;
      for (GlobalId& cell : cells) cell += kFirstCell;
      for (GlobalId& vertex : vertices) vertex += kFirstVertex;
      EXPECT_EQ(found.worst[i].cells, cells) << claim;
      EXPECT_EQ(found.worst[i].vertices, vertices) << claim;
    }
  }
  EXPECT_EQ(far.at("structure").verdict, Verdict::kFail);
}

}  // namespace
}  // namespace podm::verify
