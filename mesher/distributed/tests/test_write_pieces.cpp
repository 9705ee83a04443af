// Ranks together write the same files as a single rank, complete or not at all.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <filesystem>

#include "distributed/in_process_ranks.h"
#include "distributed/write_pieces.h"
#include "io/tests/kuhn_mesh.h"
#include "io/tests/split_mesh.h"
#include "io/write_pvtu.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"
#include "tests/fault_of.h"
#include "tests/full_disk.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Write = void (*)(const MeshPiece&, const std::string&, Communication&);

void write_in_pieces(const TetMesh& mesh, int num_pieces, const std::string& path, Write write) {
  const std::vector<MeshPiece> pieces = split_into_pieces(mesh, num_pieces);
  InProcessOptions options;
  options.num_ranks = num_pieces;
  run_ranks(options, [&](Communication& ranks) {
    write(pieces[static_cast<std::size_t>(ranks.rank())], path, ranks);
  });
}

// Returns all numbers of a dataset, row by row.
template <class Value>
std::vector<Value> read_dataset(const std::string& path, const std::string& name, hid_t type) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset);
  std::vector<Value> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  EXPECT_GE(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(file);
  return values;
}

std::vector<std::int64_t> read_integers(const std::string& path, const std::string& name) {
  return read_dataset<std::int64_t>(path, name, H5T_NATIVE_INT64);
}

// Returns the points of cells or facets, in the order of rows. They do not depend on the numbers of vertices.
std::vector<double> corners_of(const std::string& path, const std::string& name) {
  const auto points = read_dataset<double>(path, "points", H5T_NATIVE_DOUBLE);
  std::vector<double> corners;
  for (const std::int64_t vertex : read_integers(path, name))
    for (int axis = 0; axis < 3; ++axis)
      corners.push_back(points.at(static_cast<std::size_t>(3 * vertex + axis)));
  return corners;
}

// Returns the mesh with its cells and facets in the order of the pieces.
TetMesh in_order_of_pieces(const TetMesh& mesh, int num_pieces) {
  TetMesh ordered = mesh;
  std::vector<std::uint32_t> vertex_of(mesh.vertices.size());
  ordered.facets.clear();
  ordered.facet_labels.clear();
  ordered.cells.clear();
  for (const MeshPiece& piece : split_into_pieces(mesh, num_pieces)) {
    const auto number = [&](auto corners) {
      for (auto& vertex : corners) vertex = static_cast<std::uint32_t>(piece.vertex_ids[vertex]);
      return corners;
    };
    for (std::size_t v = 0; v < piece.vertex_ids.size(); ++v)
      ordered.vertices[piece.vertex_ids[v]] = piece.mesh.vertices[v];
    for (const auto& cell : piece.mesh.cells) ordered.cells.push_back(number(cell));
    for (const auto& facet : piece.mesh.facets) ordered.facets.push_back(number(facet));
    for (const auto& labels : piece.mesh.facet_labels) ordered.facet_labels.push_back(labels);
  }
  return ordered;
}

TEST(WriteXdmf, RanksWriteWhatOneWouldToTheByte) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  for (const int num_pieces : {1, 2, 5}) {
    write_mesh(in_order_of_pieces(mesh, num_pieces), folder / "one.xdmf");
    write_in_pieces(mesh, num_pieces, folder / "all.xdmf", write_xdmf);
    EXPECT_EQ(folder.read("all.h5"), folder.read("one.h5")) << num_pieces;
  }
  EXPECT_EQ(folder.files(), (std::set<std::string>{"all.h5", "all.xdmf", "one.h5", "one.xdmf"}));
}

TEST(WriteXdmf, TheArraysHoldTheMesh) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  mesh.labels[2].value = 40;  // a value that an int32 holds
  write_in_pieces(mesh, 3, folder / "a.xdmf", write_xdmf);
  const std::string path = folder / "a.h5";
  std::vector<double> corners;
  std::vector<std::int64_t> labels;
  for (const auto& cell : mesh.cells)
    for (const std::uint32_t vertex : cell)
      corners.insert(corners.end(), mesh.vertices[vertex].begin(), mesh.vertices[vertex].end());
  for (const LabelIndex label : mesh.cell_labels) labels.push_back(mesh.labels[label].value);
  EXPECT_EQ(corners_of(path, "cells"), corners);
  EXPECT_EQ(read_integers(path, "cell_labels"), labels);
  EXPECT_EQ(corners_of(path, "facets").size(), 9 * mesh.facets.size());
  EXPECT_EQ(read_integers(path, "labels/value"), (std::vector<std::int64_t>{0, 7, 40, 2}));

  const auto tags = read_integers(path, "facet_tags"), sides = read_integers(path, "facet_labels"),
             pairs = read_integers(path, "pairs/labels");
  ASSERT_EQ(sides.size(), 2 * tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i)
    for (std::size_t side : {0u, 1u})
      EXPECT_EQ(pairs.at(2 * static_cast<std::size_t>(tags[i] - 1) + side), sides[2 * i + side]);
}

TEST(WriteXdmf, LabelsThatAreNoTagsGoByTheirRows) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();  // one label is 3000000000
  write_in_pieces(mesh, 2, folder / "a.xdmf", write_xdmf);
  const auto labels = read_integers(folder / "a.h5", "cell_labels");
  EXPECT_TRUE(std::equal(labels.begin(), labels.end(), mesh.cell_labels.begin(), mesh.cell_labels.end()));
}

// Each partition numbers its own points, and together they have each cell of the mesh once.
TEST(WriteVtkhdf, EachPieceIsAPartition) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  const int num_pieces = 3;
  write_in_pieces(mesh, num_pieces, folder / "a.vtkhdf", write_vtkhdf);
  EXPECT_EQ(folder.files(), (std::set<std::string>{"a.vtkhdf", "a_facets.vtkhdf"}));
  const std::vector<MeshPiece> pieces = split_into_pieces(mesh, num_pieces);
  for (const bool is_facets : {false, true}) {
    const std::string path = folder / (is_facets ? "a_facets.vtkhdf" : "a.vtkhdf");
    const auto integers = [&](const std::string& name) { return read_integers(path, "VTKHDF/" + name); };
    const auto num_points = integers("NumberOfPoints"), num_cells = integers("NumberOfCells"),
               corners = integers("Connectivity"), offsets = integers("Offsets"),
               ids = integers("PointData/GlobalNodeIds");
    const auto points = read_dataset<double>(path, "VTKHDF/Points", H5T_NATIVE_DOUBLE);
    const std::int64_t per_cell = is_facets ? 3 : 4;
    std::size_t first_point = 0, corner = 0, offset = 0;
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
      const MeshPiece& of = pieces[piece];
      const auto cells = is_facets ? of.mesh.facets.size() : of.mesh.cells.size();
      ASSERT_EQ(num_cells.at(piece), static_cast<std::int64_t>(cells));
      EXPECT_EQ(integers("NumberOfConnectivityIds").at(piece), num_cells[piece] * per_cell);
      for (std::int64_t i = 0; i <= num_cells[piece]; ++i) EXPECT_EQ(offsets.at(offset++), per_cell * i);
      for (std::size_t cell = 0; cell < cells; ++cell)
        for (std::size_t i = 0; i < static_cast<std::size_t>(per_cell); ++i, ++corner) {
          const std::uint32_t vertex = is_facets ? of.mesh.facets[cell][i] : of.mesh.cells[cell][i];
          ASSERT_LT(corners.at(corner), num_points.at(piece));
          const std::size_t at = first_point + static_cast<std::size_t>(corners[corner]);
          EXPECT_EQ(ids.at(at), static_cast<std::int64_t>(of.vertex_ids[vertex]));
          for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_EQ(points.at(3 * at + axis), of.mesh.vertices[vertex][axis]);
        }
      first_point += static_cast<std::size_t>(num_points.at(piece));
    }
    EXPECT_EQ(3 * first_point, points.size());
  }
}

TEST(WriteSurfaces, RanksWriteWhatOneWouldToTheByte) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  for (const char* extension : {".ply", ".stl"}) {
    for (const int num_pieces : {1, 2, 5, 13}) {
      write_surfaces(in_order_of_pieces(mesh, num_pieces), folder / ("one" + std::string(extension)));
      write_in_pieces(mesh, num_pieces, folder / ("all" + std::string(extension)), write_surfaces);
      std::size_t num_surfaces = 0;
      for (const std::string& name : folder.files()) {
        if (!name.starts_with("one")) continue;
        EXPECT_EQ(folder.read("all" + name.substr(3)), folder.read(name)) << num_pieces << " " << name;
        ++num_surfaces;
      }
      EXPECT_EQ(2 * num_surfaces, folder.files().size());
      for (const std::string& name : folder.files()) std::filesystem::remove(folder / name);
    }
  }
}

TEST(WritePvtu, PiecesOfALargerMeshGoWithItsIndex) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  folder.write("a_7.vtu", "of somebody else");
  write_in_pieces(mesh, 4, folder / "a.pvtu", write_pvtu);
  write_in_pieces(mesh, 2, folder / "a.pvtu", write_pvtu);
  EXPECT_EQ(folder.files(), (std::set<std::string>{"a.pvtu", "a_0.vtu", "a_0_facets.vtu", "a_1.vtu",
                                                   "a_1_facets.vtu", "a_7.vtu", "a_facets.pvtu"}));
}

TEST(WritePvtu, PiecesOfARunThatWasKilledBeforeItsIndexGo) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  folder.write("a_7.vtu", "of somebody else");
  write_in_pieces(mesh, 4, folder / "a.pvtu", write_pvtu);
  EXPECT_EQ(withdraw_pvtu_index(folder / "a.pvtu", 3), 4);  // and is killed
  EXPECT_EQ(folder.files().count("a.pvtu.unfinished"), 1u);
  write_in_pieces(mesh, 1, folder / "a.pvtu", write_pvtu);
  EXPECT_EQ(folder.files(),
            (std::set<std::string>{"a.pvtu", "a_0.vtu", "a_0_facets.vtu", "a_7.vtu", "a_facets.pvtu"}));
}

TEST(WritePvtu, AnIndexOfOthersIsReplacedAndItsPiecesStay) {
  const ScratchFolder folder;
  folder.write("a.pvtu", "<Piece Source=\"a_0.vtu\"/><Piece Source=\"a_1.vtu\"/>");
  folder.write("a_1.vtu", "of somebody else");
  write_in_pieces(make_test_mesh(), 1, folder / "a.pvtu", write_pvtu);
  EXPECT_EQ(folder.read("a_1.vtu"), "of somebody else");
  EXPECT_NE(folder.read("a.pvtu").find("PUnstructuredGrid"), std::string::npos);
}

class NoSpace : public testing::TestWithParam<std::string> {};

// The earlier mesh is untouched until the first piece gets its name.
TEST_P(NoSpace, KeepsTheEarlierMesh) {
  const ScratchFolder folder;
  const Write write = write_pieces;
  write_in_pieces(make_test_mesh(4), 2, folder / GetParam(), write);
  std::map<std::string, std::string> before;
  for (const std::string& name : folder.files()) before[name] = folder.read(name);
  for (const rlim_t bytes : {0, 100, 6000, 20000}) {
    const auto write_larger = [&] { write_in_pieces(make_test_mesh(8), 2, folder / GetParam(), write); };
    {
      const FullDisk disk(bytes);
      EXPECT_NE(fault_of<InputError>(write_larger).find("cannot write " + (folder / "a")), std::string::npos)
          << bytes;
    }
    for (const auto& [name, content] : before) EXPECT_EQ(folder.read(name), content) << name << bytes;
    EXPECT_EQ(folder.files().size(), before.size()) << bytes;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, NoSpace, testing::Values("a.pvtu", "a.xdmf", "a.vtkhdf"),
                         [](const auto& instance) { return instance.param.substr(2); });

}  // namespace
}  // namespace podm
