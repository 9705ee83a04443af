// Reading every variant of every format gives the mesh that was written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "readers/read_mesh.h"
#include "readers/tests/mesh_writers.h"
#include "readers/tests/small_mesh.h"

namespace podm::verify {
namespace {

class ReadMesh : public testing::Test {
 protected:
  Mesh read(const std::string& name, const std::string& bytes) const {
    write_bytes(folder_ / name, bytes);
    return read_mesh(folder_ / name);
  }
  // Compares cells, labels and facets, read plain and gzipped.
  void expect_read(const std::string& name, const std::string& bytes, const std::string& label_array) const {
    SCOPED_TRACE(name);
    for (const bool is_gzipped : {false, true}) {
      const Mesh mesh = is_gzipped ? read(name + ".gz", gzipped(bytes)) : read(name, bytes);
      expect_same_cells(mesh, written_);
      expect_same_facets(mesh, written_);
      EXPECT_EQ(mesh.cell_label_array, label_array);
      EXPECT_EQ(mesh.format.ends_with(", gzip"), is_gzipped);
      EXPECT_EQ(mesh.space, Space::kUnstated);
      EXPECT_TRUE(mesh.other_cells.empty());
    }
  }

  const TestFolder folder_;
  const Mesh written_ = make_small_mesh();
};

std::vector<VtuOptions> all_vtu_options() {
  std::vector<VtuOptions> all;
  for (const auto encoding :
       {VtuOptions::kAscii, VtuOptions::kInline, VtuOptions::kAppendedRaw, VtuOptions::kAppendedBase64})
    for (int bits = 0; bits < 16; ++bits)
      for (const char* id_type : {"Int32", "Int64", "UInt32", "UInt64"})
        for (const char* label_type : {"UInt8", "Int16", "Float64"})
          all.push_back({encoding, (bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, id_type,
                         (bits & 8) != 0 ? "Float32" : "Float64", label_type, 1, 64});
  return all;
}

TEST_F(ReadMesh, VtuOfEveryEncodingTypeAndByteOrder) {
  for (const VtuOptions& options : all_vtu_options()) {
    const Mesh mesh = read("a.vtu", vtu_text(written_, options));
    expect_same_cells(mesh, written_);
    EXPECT_EQ(mesh.cell_label_array, "label");
    ASSERT_FALSE(HasFailure()) << mesh.format << options.id_type << options.label_type << options.real_type;
  }
}

TEST_F(ReadMesh, VtuGzipped) {
  expect_same_cells(read("a.vtu.gz", gzipped(vtu_text(written_, {}))), written_);
}

// Ids count from the points of their piece, which are appended to the points of earlier pieces.
TEST_F(ReadMesh, VtuPiecesAreAppended) {
  const std::size_t num_vertices = written_.vertices.size();
  Mesh expected = written_;
  expected.vertices.insert(expected.vertices.end(), written_.vertices.begin(), written_.vertices.end());
  for (VertexId& id : expected.cells.back()) id += static_cast<VertexId>(num_vertices);
  for (const auto encoding : {VtuOptions::kAscii, VtuOptions::kInline, VtuOptions::kAppendedRaw}) {
    VtuOptions options;
    options.encoding = encoding;
    options.num_pieces = 2;
    expect_same_cells(read("a.vtu", vtu_text(written_, options)), expected);
  }
}

TEST_F(ReadMesh, LegacyVtk) {
  for (const bool is_binary : {false, true})
    for (const bool has_offsets : {false, true})
      expect_read("a.vtk", legacy_vtk_text(written_, is_binary, has_offsets), "label");
}

TEST_F(ReadMesh, MeditText) { expect_read("a.mesh", medit_text(written_), "medit:ref"); }

TEST_F(ReadMesh, MeditBinaryOfEveryVersionAndByteOrder) {
  for (int version = 1; version <= 4; ++version)
    for (const bool is_big_endian : {false, true})
      expect_read("a.meshb", medit_bytes(written_, version, is_big_endian), "medit:ref");
}

TEST_F(ReadMesh, Gmsh2) {
  expect_read("a.msh", gmsh_v2_text(written_), "gmsh:physical");
  for (const bool is_big_endian : {false, true})
    expect_read("a.msh", gmsh_v2_bytes(written_, is_big_endian), "gmsh:physical");
}

TEST_F(ReadMesh, Gmsh4) {
  expect_read("a.msh", gmsh_v4_text(written_), "gmsh:physical");
  for (const int size_bytes : {4, 8})
    for (const bool is_big_endian : {false, true})
      expect_read("a.msh", gmsh_v4_bytes(written_, size_bytes, is_big_endian), "gmsh:physical");
}

TEST_F(ReadMesh, GmshNodeTagsMayStartAnywhereAndHaveGaps) {
  expect_read("a.msh", gmsh_v4_text(written_, 100, 1), "gmsh:physical");
  expect_read("a.msh", gmsh_v4_text(written_, 5, 1000000007), "gmsh:physical");
}

TEST_F(ReadMesh, TetgenFromEitherFileAndEitherBase) {
  for (const int base : {0, 1}) {
    write_bytes(folder_ / "a.face", tetgen_faces(written_, base));
    write_bytes(folder_ / "a.ele", tetgen_elements(written_, base));
    for (const bool is_gzipped : {false, true}) {
      const std::string nodes = tetgen_nodes(written_, base);
      std::filesystem::remove(folder_ / "a.node");
      write_bytes(folder_ / (is_gzipped ? "a.node.gz" : "a.node"), is_gzipped ? gzipped(nodes) : nodes);
      for (const char* name : {"a.ele", is_gzipped ? "a.node.gz" : "a.node"}) {
        const Mesh mesh = read_mesh(folder_ / name);
        expect_same_cells(mesh, written_);
        expect_same_facets(mesh, written_);
        EXPECT_EQ(mesh.format.substr(0, 15), fmt::format("TetGen, {}-based", base));
      }
      std::filesystem::remove(folder_ / "a.node.gz");
    }
  }
}

TEST_F(ReadMesh, ExtensionsInCapitals) { expect_same_cells(read("A.VTU", vtu_text(written_, {})), written_); }

// Readers pass on coordinates and ids that make no sense; the structure claim judges them.
TEST_F(ReadMesh, CoordinatesThatAreNotFinite) {
  const Mesh mesh = read("a.mesh",
                         "MeshVersionFormatted 2 Dimension 3 Vertices 2 nan inf -inf 0 1e999 -1e-999 +2.5 0\n"
                         "Tetrahedra 0 End");
  ASSERT_EQ(mesh.vertices.size(), 2u);
  const Point &a = mesh.vertices[0], &b = mesh.vertices[1];
  EXPECT_TRUE(std::isnan(a[0]));
  EXPECT_EQ(a[1], HUGE_VAL);
  EXPECT_EQ(a[2], -HUGE_VAL);
  EXPECT_EQ(b, (Point{HUGE_VAL, 0, 2.5}));
}

TEST_F(ReadMesh, IdsThatNameNoVertex) {
  const std::string head = "MeshVersionFormatted 2 Dimension 3 Vertices 1 0 0 0 0 Tetrahedra 1 ";
  const Mesh medit = read("a.mesh", head + "0 -5 9 9999999999 3 End");
  EXPECT_EQ(medit.cells[0], (std::array<VertexId, 4>{kNone, kNone, 8, kNone}));

  Mesh wrong = written_;
  wrong.cells[1][2] = 600;
  for (const char* type : {"Int32", "Int64", "UInt64"}) {
    VtuOptions options;
    options.id_type = type;
    EXPECT_EQ(read("a.vtu", vtu_text(wrong, options)).cells, wrong.cells);
  }
  VtuOptions pieces;  // with pieces, 600 might be a vertex of another piece
  pieces.num_pieces = 2;
  EXPECT_EQ(read("a.vtu", vtu_text(wrong, pieces)).cells[1][2], kNone);
  EXPECT_EQ(read("a.msh", gmsh_v4_text(wrong)).cells[1][2], kNone);  // a tag, not an id
}

TEST_F(ReadMesh, OtherCellsAreCountedAndQuadraticOnesReadByTheirCorners) {
  const std::string vtk =
      "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 float\n" +
      std::string("0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n") +
      "CELLS 5 34\n8 0 1 2 3 4 5 6 7\n10 3 2 1 0 4 5 6 7 8 9\n2 0 1\n4 0 1 2 3\n5 0 1 2 3 4\n"
      "CELL_TYPES 5\n12 24 3 10 14\nCELL_DATA 5\nFIELD f 1\nMaterialID 1 5 float\n1 2 3 4 5\n";
  const Mesh mesh = read("a.vtk", vtk);
  EXPECT_EQ(mesh.cells, (std::vector<std::array<VertexId, 4>>{{3, 2, 1, 0}, {0, 1, 2, 3}}));
  EXPECT_EQ(mesh.cell_labels, (std::vector<LabelValue>{2, 4}));
  EXPECT_EQ(mesh.cell_label_array, "MaterialID");
  EXPECT_EQ(
      mesh.other_cells,
      (std::map<std::string, std::size_t>{
          {"hexahedra", 1}, {"lines", 1}, {"pyramids", 1}, {"quadratic tetrahedra (corners read)", 1}}));
}

TEST_F(ReadMesh, GmshElementsWithoutPhysicalGroupHaveTheirEntityAsLabel) {
  const Mesh mesh = read("a.msh",
                         "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Other\nany $thing\n$EndOther\n"
                         "$PhysicalNames\n1\n3 12 \"a group, no entity\"\n$EndPhysicalNames\n"
                         "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
                         "$Elements\n2\n1 15 2 0 1 1\n2 4 3 0 12 99 1 2 3 4\n$EndElements\n");
  EXPECT_EQ(mesh.cell_labels, (std::vector<LabelValue>{12}));
  EXPECT_EQ(mesh.cell_label_array, "gmsh:geometrical");
  EXPECT_TRUE(mesh.label_names.empty());
  EXPECT_EQ(mesh.other_cells, (std::map<std::string, std::size_t>{{"vertices", 1}}));
}

std::string inserted(std::string text, const std::string& before, const std::string& words) {
  return text.insert(text.find(before), words);
}

// Every format that has a place for podm's promises is read. The tests of the program cover netCDF.
TEST_F(ReadMesh, TheWidthOfSmoothingThatTheFileStates) {
  const auto files_that_say = [&](const std::string& words) {
    const std::string comment = "# promise " + words + "\n",
                      gmsh = "$Comments\npromise " + words + "\n$EndComments\n";
    std::string in_name = words;
    for (std::size_t i; (i = in_name.find(' ')) != std::string::npos;) in_name.replace(i, 1, "%20");
    write_bytes(folder_ / "a.node", tetgen_nodes(written_, 0));
    return std::map<std::string, std::string>{
        {"a.vtu", inserted(vtu_text(written_, {}), "<Piece",
                           "<FieldData><DataArray type=\"Int32\" Name=\"promise:" + words +
                               "\" NumberOfTuples=\"1\" format=\"ascii\">1</DataArray></FieldData>")},
        {"a.vtk", inserted(legacy_vtk_text(written_, false, false), "POINTS",
                           "FIELD FieldData 1\npromise:" + in_name + " 1 1 int\n1\n")},
        {"a.mesh", inserted(medit_text(written_), "Dimension", comment)},
        {"2.msh", inserted(gmsh_v2_text(written_), "$Nodes", gmsh)},
        {"4.msh", inserted(gmsh_v4_text(written_), "$Nodes", gmsh)},
        {"a.ele", comment + tetgen_elements(written_, 0)},
        {"a.inp", "** promise " + words +
                      "\n*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4\n1, 1, "
                      "2, 3, 4\n"}};
  };
  for (const auto& [name, bytes] : files_that_say("smoothed 1.5"))
    EXPECT_EQ(read(name, bytes).smoothing_mm, 1.5) << name;
  for (const auto& [name, bytes] : files_that_say("unclaimed delaunay"))
    EXPECT_EQ(read(name, bytes).smoothing_mm, std::nullopt) << name;
  for (const char* words : {"smoothed -1.5", "smoothed 0", "smoothed nan", "smoothed inf", "smoothed much",
                            "smoothed", "smoothed 1.5mm", "smoothed 1 2", "smooth 1"})
    for (const auto& [name, bytes] : files_that_say(words))
      expect_refused(folder_, name, bytes, {"promise", words});
}

TEST_F(ReadMesh, ColoursOfLabels) {
  const auto files_with = [&](int components, int tuples, const std::string& numbers) {
    const std::string sizes = std::to_string(components) + " " + std::to_string(tuples);
    return std::map<std::string, std::string>{
        {"a.vtu",
         inserted(vtu_text(written_, {}), "<Piece",
                  "<FieldData><DataArray type=\"Int32\" Name=\"label_colours\" NumberOfComponents=\"" +
                      std::to_string(components) + "\" NumberOfTuples=\"" + std::to_string(tuples) +
                      "\" format=\"ascii\">" + numbers + "</DataArray></FieldData>")},
        {"a.vtk", inserted(legacy_vtk_text(written_, false, false), "POINTS",
                           "FIELD FieldData 1\nlabel_colours " + sizes + " int\n" + numbers + "\n")}};
  };
  using Colours = std::map<LabelValue, std::array<std::uint8_t, 3>>;
  for (const auto& [name, bytes] : files_with(4, 2, "7 255 0 51 2 1 2 3"))
    EXPECT_EQ(read(name, bytes).label_colours, (Colours{{7, {255, 0, 51}}, {2, {1, 2, 3}}})) << name;
  for (const auto& [name, bytes] : files_with(4, 1, "7 256 0 51"))
    expect_refused(folder_, name, bytes, {"a label value and a colour from 0 to 255"});
  for (const auto& [name, bytes] : files_with(3, 1, "255 0 51"))
    expect_refused(folder_, name, bytes, {"a label value and a colour from 0 to 255"});
}

TEST_F(ReadMesh, VtuArraysOfTextAreNoLabels) {
  std::string vtu = vtu_text(written_, {});
  vtu.insert(vtu.find("<DataArray type=\"Float32\""),
             "<Array type=\"String\" Name=\"label\" format=\"ascii\">97 0</Array>");
  expect_same_cells(read("a.vtu", vtu), written_);
}

// An array of fractions is no label array, whatever its name.
TEST_F(ReadMesh, LabelsAreIntegers) {
  std::string vtk = legacy_vtk_text(written_, false, false);
  vtk.replace(vtk.find("label int"), 9, "material float");
  EXPECT_EQ(read("a.vtk", vtk).cell_label_array, "material");
  vtk.replace(vtk.rfind("7"), 1, "7.5");
  const Mesh mesh = read("a.vtk", vtk);
  EXPECT_EQ(mesh.cell_label_array, "");
  EXPECT_TRUE(mesh.cell_labels.empty());
  EXPECT_EQ(mesh.cells, written_.cells);
}

}  // namespace
}  // namespace podm::verify
