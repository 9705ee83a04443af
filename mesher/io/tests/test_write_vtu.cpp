// VTU files as VTK's own reader reads them, through a script for the system's Python.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <sstream>

#include "io/tests/kuhn_mesh.h"
#include "io/tests/mesh_readers.h"
#include "io/tests/split_mesh.h"
#include "io/write_pvtu.h"
#include "podm/mesh_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

struct VtuContent {
  std::vector<std::array<double, 3>> points;
  std::vector<std::vector<std::uint32_t>> cells;           // VTK's type of the cell, then its points
  std::map<std::string, std::vector<std::string>> arrays;  // keys such as "cell label"
  std::map<std::string, std::string> field;
  std::string global_ids;  // the array that VTK uses as global ids
  double area = 0, volume = 0;
};

VtuContent parse(const std::string& path) {
  std::istringstream lines(read_bytes(path));
  VtuContent content;
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string kind, second, third;
    words >> kind >> second >> third;
    if (kind == "points") {
      for (int n = std::stoi(second); n > 0 && std::getline(lines, line); --n) {
        std::istringstream coordinates(line);
        std::string x, y, z;
        coordinates >> x >> y >> z;
        content.points.push_back({std::stod(x), std::stod(y), std::stod(z)});
      }
    } else if (kind == "cells") {
      for (int n = std::stoi(second); n > 0 && std::getline(lines, line); --n) {
        std::istringstream numbers(line);
        content.cells.emplace_back(std::istream_iterator<std::uint32_t>(numbers),
                                   std::istream_iterator<std::uint32_t>());
      }
    } else if (kind == "area" || kind == "volume") {
      (kind == "area" ? content.area : content.volume) = std::stod(second);
    } else if (kind == "globalids") {
      content.global_ids = second;
    } else if (kind == "field") {
      content.field[line.substr(line.find(' ') + 1, line.find('\t') - line.find(' ') - 1)] =
          line.substr(line.find('\t') + 1);
    } else {
      auto& values = content.arrays[kind + " " + second];
      for (int n = std::stoi(third); n > 0 && std::getline(lines, line); --n) values.push_back(line);
    }
  }
  return content;
}

class VtuFile : public testing::Test {
 protected:
  void SetUp() override {
    const std::string probe = std::string(PODM_VTK_PYTHON) + " -c 'import vtk' 2>/dev/null";
    if (std::system(probe.c_str()) != 0) GTEST_SKIP() << "skipped: needs the package python3-vtk9";
  }
  VtuContent read(const std::string& name) {
    const std::string text = folder_ / (name + ".txt");
    const std::string command =
        std::string(PODM_VTK_PYTHON) + " " + PODM_VTU_TO_TEXT + " " + (folder_ / name) + " > " + text;
    EXPECT_EQ(std::system(command.c_str()), 0);
    return parse(text);
  }
  std::vector<std::string> values_of(const TetMesh& mesh, const std::vector<LabelIndex>& labels) {
    std::vector<std::string> values;
    for (const LabelIndex label : labels) values.push_back(std::to_string(mesh.labels[label].value));
    return values;
  }
  const ScratchFolder folder_;
};

TEST_F(VtuFile, VtkReadsTheMeshThatWasWritten) {
  TetMesh mesh = make_test_mesh();
  mesh.space = Space::kLps;
  mesh.labels[3].name = "<left> & \"right\"";
  canonicalize(mesh);
  write_mesh(mesh, folder_ / "a.vtu");
  const VtuContent content = read("a.vtu");

  EXPECT_EQ(content.points, mesh.vertices);
  std::vector<std::vector<std::uint32_t>> cells;
  for (const auto& [a, b, c, d] : mesh.cells) cells.push_back({10, a, b, c, d});
  EXPECT_EQ(content.cells, cells);
  EXPECT_EQ(content.arrays.at("cell label"), values_of(mesh, mesh.cell_labels));
  EXPECT_EQ(content.field, (std::map<std::string, std::string>{{"space:LPS", "1"},
                                                               {"label:outside", "0"},
                                                               {"label:liver", "7"},
                                                               {"label:label 3000000000", "3000000000"},
                                                               {"label:<left> & 'right'", "2"}}));
  double volume = 0;
  for (LabelIndex label = 1; label < mesh.labels.size(); ++label) volume += volume_of_label(mesh, label);
  EXPECT_NEAR(content.volume, volume, 1e-9 * volume);
}

TEST_F(VtuFile, ColoursOfLabelsAreRowsOfFourNumbers) {
  TetMesh mesh = make_test_mesh();
  mesh.labels[0].colour = Rgb{9, 9, 9};  // the background has no row
  mesh.labels[1].colour = Rgb{255, 0, 51};
  mesh.labels[3].colour = Rgb{1, 2, 3};
  canonicalize(mesh);
  write_mesh(mesh, folder_ / "a.vtu");
  const std::string rows =
      std::to_string(mesh.labels[1].value) + " 255 0 51 " + std::to_string(mesh.labels[3].value) + " 1 2 3";
  for (const char* name : {"a.vtu", "a_facets.vtu"}) EXPECT_EQ(read(name).field.at("label_colours"), rows);
}

TEST_F(VtuFile, TheFacetsLieBesideIt) {
  TetMesh mesh = make_test_mesh();
  canonicalize(mesh);
  write_mesh(mesh, folder_ / "a.vtu");
  const VtuContent content = read("a_facets.vtu");

  const auto& vertex = content.arrays.at("point vertex");
  ASSERT_EQ(vertex.size(), content.points.size());
  EXPECT_LT(vertex.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < vertex.size(); ++i)
    EXPECT_EQ(content.points[i], mesh.vertices.at(std::stoul(vertex[i])));
  ASSERT_EQ(content.cells.size(), mesh.facets.size());
  std::vector<LabelIndex> first, second;
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    ASSERT_EQ(content.cells[i][0], 5u);
    for (int v = 0; v < 3; ++v) EXPECT_EQ(std::stoul(vertex[content.cells[i][v + 1]]), mesh.facets[i][v]);
    first.push_back(mesh.facet_labels[i][0]);
    second.push_back(mesh.facet_labels[i][1]);
  }
  EXPECT_EQ(content.arrays.at("cell label_a"), values_of(mesh, first));
  EXPECT_EQ(content.arrays.at("cell label_b"), values_of(mesh, second));
  EXPECT_TRUE(content.field.count("space:RAS"));
  EXPECT_GT(content.area, 0);
}

TEST_F(VtuFile, AMeshWithoutFacetsIsAllowed) {
  TetMesh mesh = make_test_mesh();
  mesh.facets.clear();
  mesh.facet_labels.clear();
  write_mesh(mesh, folder_ / "a.vtu");
  EXPECT_EQ(read("a.vtu").cells.size(), mesh.cells.size());
  EXPECT_TRUE(read("a_facets.vtu").cells.empty());
}

class PvtuFile : public VtuFile {
 protected:
  void write_pieces(const TetMesh& mesh, int num_pieces) {
    for (const MeshPiece& piece : split_into_pieces(mesh, num_pieces)) {
      std::deque<AtomicFile> files = write_pvtu_piece(piece, folder_ / "a.pvtu");
      publish_together(files);
    }
    write_pvtu_index(folder_ / "a.pvtu", num_pieces, 0);
  }
};

// Points with the same number, in any pieces, are one vertex.
std::map<std::uint64_t, std::array<double, 3>> points_by_id(const VtuContent& content) {
  std::map<std::uint64_t, std::array<double, 3>> points;
  const auto& ids = content.arrays.at("point GlobalNodeIds");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto [entry, is_new] = points.try_emplace(std::stoull(ids[i]), content.points.at(i));
    EXPECT_EQ(entry->second, content.points[i]);
  }
  return points;
}

TEST_F(PvtuFile, VtkReadsThePiecesAsOneMesh) {
  TetMesh mesh = make_test_mesh();
  mesh.labels[3].name = "\"left\" & <right>";
  for (const int num_pieces : {1, 3, 8}) {
    write_pieces(mesh, num_pieces);
    const VtuContent content = read("a.pvtu");
    EXPECT_EQ(content.global_ids, "GlobalNodeIds");
    EXPECT_EQ(content.arrays.at("cell label"), values_of(mesh, mesh.cell_labels));
    const auto points = points_by_id(content);
    ASSERT_EQ(points.size(), mesh.vertices.size());
    EXPECT_EQ(points.rbegin()->first, mesh.vertices.size() - 1);
    ASSERT_EQ(content.cells.size(), mesh.cells.size());
    for (std::size_t i = 0; i < mesh.cells.size(); ++i)
      for (int v = 0; v < 4; ++v)
        EXPECT_EQ(content.points[content.cells[i][v + 1]], mesh.vertices[mesh.cells[i][v]]);
    EXPECT_EQ(content.points.size() > points.size(), num_pieces > 1);
  }
}

TEST_F(PvtuFile, TheFacetsHaveAnIndexOfTheirOwn) {
  const TetMesh mesh = make_test_mesh();
  write_pieces(mesh, 3);
  const VtuContent cells = read("a.pvtu"), facets = read("a_facets.pvtu");
  EXPECT_EQ(facets.cells.size(), mesh.facets.size());
  std::vector<LabelIndex> first, second;
  for (const auto& [a, b] : mesh.facet_labels) first.push_back(a), second.push_back(b);
  for (const auto& [name, side] : {std::pair{"cell label_a", &first}, std::pair{"cell label_b", &second}}) {
    auto values = facets.arrays.at(name), expected = values_of(mesh, *side);
    std::sort(values.begin(), values.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(values, expected);
  }
  const auto points = points_by_id(cells);
  for (const auto& [id, point] : points_by_id(facets)) EXPECT_EQ(points.at(id), point);
}

TEST_F(PvtuFile, RanksWithoutCellsAreAllowed) {
  const TetMesh mesh = make_kuhn_mesh(1, 1, [](int, int, int) -> LabelIndex { return 1; });
  write_pieces(mesh, 10);
  EXPECT_EQ(read("a.pvtu").cells.size(), mesh.cells.size());
  EXPECT_EQ(read("a_facets.pvtu").cells.size(), mesh.facets.size());
}

TEST_F(PvtuFile, APieceIsAMeshFileOfItsOwn) {
  const TetMesh mesh = make_test_mesh();
  write_pieces(mesh, 3);
  const VtuContent cells = read("a_1.vtu"), facets = read("a_1_facets.vtu");
  const auto& vertex = facets.arrays.at("point vertex");
  for (std::size_t i = 0; i < vertex.size(); ++i)
    EXPECT_EQ(facets.points[i], cells.points.at(std::stoul(vertex[i])));
  EXPECT_TRUE(cells.field.count("label:liver"));
}

}  // namespace
}  // namespace podm
