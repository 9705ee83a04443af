// Reads files written by VTK's own writers and by podm.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <set>

#include "readers/read_mesh.h"
#include "readers/tests/small_mesh.h"

namespace podm::verify {
namespace {

TEST(ReadVtkFiles, EveryWayVtkWritesAGrid) {
  if (std::system(PODM_VTK_PYTHON " -c 'import vtk' 2>/dev/null") != 0)
    GTEST_SKIP() << "skipped: needs the package python3-vtk9";
  const TestFolder folder;
  const std::string list = folder / "list";
  ASSERT_EQ(std::system((PODM_VTK_PYTHON " " PODM_VTK_VARIANTS " " + folder.path() + " > " + list).c_str()),
            0);

  Mesh expected;
  for (int i = 0; i < 12; ++i) expected.vertices.push_back({i / 8.0, i * i / 4.0, -i / 16.0});
  expected.cells = {{0, 1, 2, 3}, {0, 1, 2, 3}};
  expected.cell_labels = {3, 200};
  std::ifstream names(list);
  int num_files = 0;
  for (std::string name; std::getline(names, name); ++num_files) {
    SCOPED_TRACE(name);
    const Mesh mesh = read_mesh(folder / name);
    expect_same_cells(mesh, expected);
    EXPECT_EQ(mesh.facets, (std::vector<std::array<VertexId, 3>>{{7, 8, 9}}));
    EXPECT_EQ(mesh.cell_label_array, "CellEntityIds");
    EXPECT_EQ(mesh.other_cells, (std::map<std::string, std::size_t>{
                                    {"pyramids", 1}, {"quadratic tetrahedra (corners read)", 1}}));
  }
  EXPECT_EQ(num_files, 52);
}

// Returns the mesh with vertices sorted by coordinates, then cells and facets sorted by vertices: formats may
// reorder all of them.
Mesh sorted(const Mesh& mesh) {
  std::vector<VertexId> order(mesh.vertices.size()), position(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](VertexId a, VertexId b) { return mesh.vertices[a] < mesh.vertices[b]; });
  Mesh result;
  for (const VertexId vertex : order) {
    position[vertex] = static_cast<VertexId>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[vertex]);
  }
  std::vector<std::pair<std::array<VertexId, 4>, LabelValue>> cells;
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    auto cell = mesh.cells[i];
    for (VertexId& id : cell) id = position.at(id);
    std::sort(cell.begin(), cell.end());
    cells.emplace_back(cell, mesh.cell_labels.at(i));
  }
  std::vector<std::pair<std::array<VertexId, 3>, std::array<LabelValue, 2>>> facets;
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    auto facet = mesh.facets[i];
    for (VertexId& id : facet) id = position.at(id);
    std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
    facets.emplace_back(facet, mesh.facet_labels.at(i));
  }
  std::sort(cells.begin(), cells.end());
  std::sort(facets.begin(), facets.end());
  for (const auto& [cell, label] : cells) {
    result.cells.push_back(cell);
    result.cell_labels.push_back(label);
  }
  for (const auto& [facet, labels] : facets) {
    result.facets.push_back(facet);
    result.facet_labels.push_back(labels);
  }
  return result;
}

class ReadOurMesh : public testing::TestWithParam<std::pair<const char*, Space>> {
 protected:
  Mesh mesh_as(const std::string& name) const {
    const std::string command = fmt::format("{} mesh phantom:spheres@24 --quiet --threads 1 --space {} -o {}",
                                            PODM_PROGRAM, GetParam().first, folder_ / name);
    EXPECT_EQ(std::system(command.c_str()), 0);
    return read_mesh(folder_ / name);
  }
  const TestFolder folder_;
};

TEST_P(ReadOurMesh, IsTheSameInEveryFormat) {
  const Mesh vtu = mesh_as("a.vtu");
  EXPECT_GT(vtu.cells.size(), 100u);
  EXPECT_GT(vtu.facets.size(), 100u);
  const std::set<LabelValue> labels(vtu.cell_labels.begin(), vtu.cell_labels.end());
  const Mesh expected = sorted(vtu);
  for (const char* name : {"a.vtu", "a.mesh", "a.msh"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = std::string(name) == "a.vtu" ? vtu : mesh_as(name);
    const Mesh found = sorted(mesh);
    expect_same_cells(found, expected);
    expect_same_facets(found, expected);
    for (const LabelValue label : labels) EXPECT_EQ(mesh.label_names.at(label), vtu.label_names.at(label));
    EXPECT_EQ(mesh.space, GetParam().second);
    EXPECT_TRUE(mesh.other_cells.empty());
  }
}

// Each facet is a side of a cell of each of its labels, or of one cell if the other label is outside.
TEST_P(ReadOurMesh, FacetsAreSidesOfCellsOfTheirLabels) {
  const Mesh mesh = mesh_as("a.vtu");
  std::map<std::array<VertexId, 3>, std::vector<LabelValue>> labels_at;
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    for (int opposite = 0; opposite < 4; ++opposite) {
      std::array<VertexId, 3> facet;
      for (int k = 0; k < 3; ++k) facet[k] = mesh.cells[i][(opposite + 1 + k) % 4];
      std::sort(facet.begin(), facet.end());
      labels_at[facet].push_back(mesh.cell_labels[i]);
    }
  }
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    auto facet = mesh.facets[i];
    std::sort(facet.begin(), facet.end());
    auto expected = labels_at[facet];
    if (expected.size() == 1) expected.push_back(0);
    std::array<LabelValue, 2> labels = mesh.facet_labels[i];
    std::sort(expected.begin(), expected.end());
    std::sort(labels.begin(), labels.end());
    EXPECT_EQ(expected, (std::vector<LabelValue>(labels.begin(), labels.end())));
  }
}

TEST_P(ReadOurMesh, AFacetsFileOfAnotherMeshIsRefused) {
  mesh_as("a.vtu");
  std::string bytes = read_bytes(folder_ / "a.vtu");
  const Mesh mesh = read_mesh(folder_ / "a.vtu");
  Point moved = mesh.vertices[mesh.facets[0][0]];
  const std::string old(reinterpret_cast<const char*>(moved.data()), sizeof(moved));
  moved[1] += 0.5;
  const std::string now(reinterpret_cast<const char*>(moved.data()), sizeof(moved));
  bytes.replace(bytes.find(old), old.size(), now);
  write_bytes(folder_ / "a.vtu", bytes);
  const std::string message = refusal_of(folder_ / "a.vtu");
  EXPECT_TRUE(message.starts_with(folder_ / "a_facets.vtu: ")) << message;
  EXPECT_NE(message.find("do not belong together"), std::string::npos) << message;
}

// An information record of an Exodus file has 80 bytes; "space RAS" leaves most of them empty.
TEST(ReadOurExodus, StatesTheWidthOfSmoothing) {
  const TestFolder folder;
  const std::string path = folder / "a.exo";
  ASSERT_EQ(
      std::system(
          fmt::format("{} mesh phantom:spheres@24 --quiet --threads 1 -o {}", PODM_PROGRAM, path).c_str()),
      0);
  EXPECT_EQ(read_mesh(path).smoothing_mm, std::nullopt);
  std::string bytes = read_bytes(path);
  const std::size_t record = bytes.find("space RAS");
  ASSERT_NE(record, std::string::npos);
  for (const std::string words : {"promise smoothed 1.5", "promise smoothed -1."}) {
    write_bytes(path, bytes.replace(record, words.size(), words));
    if (words.ends_with("1.5")) {
      EXPECT_EQ(read_mesh(path).smoothing_mm, 1.5);
    } else {
      EXPECT_NE(refusal_of(path).find("info_records: the promise 'smoothed -1.'"), std::string::npos);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Spaces, ReadOurMesh,
                         testing::Values(std::pair("RAS", Space::kRas), std::pair("LPS", Space::kLps),
                                         std::pair("voxel", Space::kVoxel)),
                         [](const auto& instance) { return std::string(instance.param.first); });

}  // namespace
}  // namespace podm::verify
