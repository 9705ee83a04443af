// Every fault ends in an InputError that names the file, the place in it and the fault.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "errors.h"
#include "readers/read_mesh.h"
#include "readers/tests/mesh_writers.h"
#include "readers/tests/small_mesh.h"

namespace podm::verify {
namespace {

using Words = std::vector<std::string>;

class RefuseMesh : public testing::Test {
 protected:
  void refuse(const std::string& name, const std::string& bytes, const Words& words) const {
    expect_refused(folder_, name, bytes, words);
  }
  // Refuses `bytes` with the first `old` replaced by `now`.
  void refuse_edited(const std::string& name, std::string bytes, const std::string& old,
                     const std::string& now, const Words& words) const {
    SCOPED_TRACE(old + " -> " + now);
    const std::size_t place = bytes.find(old);
    ASSERT_NE(place, std::string::npos);
    refuse(name, bytes.replace(place, old.size(), now), words);
  }
  // Only the whole file, with or without its last blanks, is a mesh. No shorter prefix is one, and none
  // crashes the reader.
  void refuse_every_prefix(const std::string& name, std::string bytes) const {
    SCOPED_TRACE(name);
    while (bytes.ends_with('\n')) bytes.pop_back();
    for (std::size_t size = 0; size < bytes.size(); ++size) refuse(name, bytes.substr(0, size), {});
  }

  const TestFolder folder_;
  const Mesh mesh_ = make_small_mesh();
};

TEST_F(RefuseMesh, FilesThatCannotBeRead) {
  EXPECT_NE(refusal_of(folder_ / "none.vtu").find("none.vtu: No such file"), std::string::npos);
  std::filesystem::create_directory(folder_ / "folder.msh");
  EXPECT_NE(refusal_of(folder_ / "folder.msh").find("not a regular file"), std::string::npos);
  refuse("a.vtu", "", {"empty"});
  refuse("a.stl", "solid", {"'.stl'", "known: .vtu"});
  refuse("a", "solid", {"known: .vtu"});
}

TEST_F(RefuseMesh, ContentOfAnotherFormat) {
  const std::string medit = medit_text(mesh_);
  for (const char* name : {"a.vtu", "a.vtk", "a.meshb", "a.msh"}) refuse(name, medit, {});
  refuse("a.mesh", gmsh_v2_text(mesh_), {"line 1", "MeshVersionFormatted"});
  refuse("a.mesh.gz", medit, {"gzip"});
}

TEST_F(RefuseMesh, GzipThatIsCutOrDamaged) {
  std::string bytes = gzipped(medit_text(mesh_));
  refuse("a.mesh.gz", bytes.substr(0, bytes.size() - 9), {"byte", "unexpected end of file"});
  bytes[bytes.size() - 6] ^= 1;  // in the checksum
  refuse("a.mesh.gz", bytes, {"incorrect data check"});
}

TEST_F(RefuseMesh, FilesCutOffAnywhere) {
  for (const auto encoding :
       {VtuOptions::kAscii, VtuOptions::kInline, VtuOptions::kAppendedRaw, VtuOptions::kAppendedBase64}) {
    for (const bool is_zlib : {false, true}) {
      VtuOptions options;
      options.encoding = encoding;
      options.is_zlib = is_zlib;
      refuse_every_prefix("a.vtu", vtu_text(mesh_, options));
    }
  }
  refuse_every_prefix("a.mesh", medit_text(mesh_));
  for (int version = 1; version <= 4; ++version) {
    std::string bytes = medit_bytes(mesh_, version, false);
    bytes.resize(bytes.size() - (version >= 3 ? 8 : 4));  // the position after End carries no information
    refuse_every_prefix("a.meshb", bytes);
  }
  refuse_every_prefix("a.msh", gmsh_v2_text(mesh_));
  refuse_every_prefix("a.msh", gmsh_v2_bytes(mesh_, false));
  refuse_every_prefix("a.msh", gmsh_v4_text(mesh_));
  refuse_every_prefix("a.msh", gmsh_v4_bytes(mesh_, 8, false));
}

// A legacy VTK file may end after its cells: nothing announced is missing then.
TEST_F(RefuseMesh, LegacyVtkCutOff) {
  for (const bool is_binary : {false, true}) {
    for (const bool has_offsets : {false, true}) {
      const std::string text = legacy_vtk_text(mesh_, is_binary, has_offsets);
      for (std::size_t size = 0; size + 3 < text.find("CELL_TYPES"); ++size)
        refuse("a.vtk", text.substr(0, size), {});
      refuse("a.vtk", text.substr(0, text.size() - 5), {"the file ends"});
    }
  }
}

TEST_F(RefuseMesh, XmlThatIsNone) {
  refuse("a.vtu", "<VTKFile type=\"UnstructuredGrid\">\n<UnstructuredGrid>\n</Wrong>\n",
         {"line 3", "mismatched"});
  refuse("a.vtu", "<html></html>", {"line 1", "VTKFile"});
  refuse("a.vtu", "<VTKFile type=\"PolyData\"></VTKFile>", {"line 1", "PolyData"});
}

TEST_F(RefuseMesh, XmlBombs) {
  const std::string file = "<VTKFile type=\"UnstructuredGrid\">&b;</VTKFile>";
  refuse("a.vtu", "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n" + file, {"document type"});
  refuse("a.vtu", file, {"undefined entity"});
  std::string deep = "<VTKFile type=\"UnstructuredGrid\">";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  refuse("a.vtu", deep, {"line 1", "nest too deep"});
  refuse("a.vtu", "<VTKFile type=\"" + std::string(5000000, 'x') + "\"></VTKFile>",
         {"line 1", "tag of more than"});
}

TEST_F(RefuseMesh, VtuAttributes) {
  const std::string text = vtu_text(mesh_, {});
  const auto edited = [&](const char* old, const char* now, const Words& words) {
    refuse_edited("a.vtu", text, old, now, words);
  };
  edited("LittleEndian", "MiddleEndian", {"line 2", "MiddleEndian"});
  edited("header_type=\"UInt64\"", "header_type=\"Int8\"", {"line 2", "header_type"});
  edited("header_type", "compressor=\"vtkLZ4DataCompressor\" header_type",
         {"line 2", "vtkLZ4DataCompressor"});
  edited("NumberOfPoints=\"6\"", "NumberOfPoints=\"-6\"", {"line 4", "NumberOfPoints=\"-6\""});
  edited("NumberOfPoints=\"6\"", "NumberOfPoints=\"18446744073709551615\"", {"line 4", "more than"});
  edited("NumberOfPoints=\"6\"", "NumberOfPoints=\"4000000000\"", {"line 6", "12000000000 are expected"});
  edited("NumberOfCells=\"3\"", "NumberOfCells=\"4\"", {"'types'", "3 values, 4 are expected"});
  edited("NumberOfCells", "NumberOfThings", {"line 4", "NumberOfCells=\"\""});
  edited("type=\"Float64\"", "type=\"Float80\"", {"line 6", "Float80"});
  edited("format=\"ascii\"", "format=\"octal\"", {"line 6", "octal"});
  edited("format=\"ascii\"", "format=\"appended\" offset=\"0\"", {"line 6", "no AppendedData"});
  edited("Name=\"offsets\"", "Name=\"onsets\"", {"line 4", "no DataArray 'offsets'"});
}

TEST_F(RefuseMesh, VtuNumbersInText) {
  const std::string text = vtu_text(mesh_, {});
  refuse_edited("a.vtu", text, "16777216", "1677x216", {"line 8", "'1677x216' is not a number"});
  refuse_edited("a.vtu", text, "4 8 12", "4 8 99999999999", {"line", "out of range"});
  refuse_edited("a.vtu", text, "4 8 12", "4 8 13", {"cell 2", "[8, 13) of 12"});
  refuse_edited("a.vtu", text, "4 8 12", "4 3 12", {"cell 1", "[4, 3) of 12"});
  refuse_edited("a.vtu", text, "4 8 12", "4 9 12", {"cell 1", "5 points"});
  refuse_edited("a.vtu", text, "4 8 12", "4 8", {"'offsets'", "2 values, 3 are expected"});
}

TEST_F(RefuseMesh, VtuBinaryData) {
  VtuOptions options;
  options.encoding = VtuOptions::kAppendedRaw;
  const std::string raw = vtu_text(mesh_, options);
  refuse_edited("a.vtu", raw, "offset=\"0\"", "offset=\"99999\"", {"line 6", "99999 lies outside the file"});
  refuse_edited("a.vtu", raw, "offset=\"0\"", "offset=\"18446744073709551615\"", {"line 6", "outside"});
  refuse_edited("a.vtu", raw, "\n_", "\n#", {"line", "'_'"});
  refuse_edited("a.vtu", raw, "\n_\x90", "\n_\x88", {"line 6", "17 values, 18 are expected"});
  refuse_edited("a.vtu", raw, "\n_\x90", "\n_\x8f", {"line 6", "143 bytes are not a whole number of values"});
  refuse_edited("a.vtu", raw, "\n_" + std::string("\x90\0\0\0", 4), "\n_\xff\xff\xff\xff",
                {"line 6", "4294967295 bytes are announced at byte"});
  options.encoding = VtuOptions::kInline;
  const std::string inlined = vtu_text(mesh_, options);
  refuse_edited("a.vtu", inlined, "AAAA", "AA!A", {"byte", "out of place"});
  refuse_edited("a.vtu", inlined, "AAAA", "A=AA", {"byte", "out of place"});
}

TEST_F(RefuseMesh, VtuCompressedBlocks) {
  VtuOptions options;
  options.encoding = VtuOptions::kAppendedRaw;
  options.is_zlib = true;
  std::string text = vtu_text(mesh_, options);
  const std::size_t header = text.find("\n_") + 2;
  const auto with_number = [&](std::size_t position, std::uint64_t number) {
    Bytes bytes(false);
    bytes.put(number);
    return std::string(text).replace(header + 8 * position, 8, bytes.text);
  };
  refuse("a.vtu", with_number(0, 1ull << 60), {"line 6", "compressed blocks are announced"});
  refuse("a.vtu", with_number(1, 1ull << 62), {"line 6", "block 0 at byte"});  // expands hugely
  refuse("a.vtu", with_number(1, 65), {"line 6", "block 0", "not of the 65 bytes"});
  refuse("a.vtu", with_number(3, 1ull << 61), {"byte", "bytes of data are needed"});
  text[header + 8 * 6 + 5] ^= 0x55;  // in the first block
  refuse("a.vtu", text, {"line 6", "block 0", "damaged"});
}

// A small file must not become a large mesh by naming the same bytes repeatedly.
TEST_F(RefuseMesh, VtuArraysThatShareTheirData) {
  VtuOptions options;
  options.encoding = VtuOptions::kAppendedRaw;
  options.num_pieces = 2;
  std::string text = vtu_text(mesh_, options);
  const std::size_t begin = text.find("<Piece"), end = text.rfind("</Piece>") + 8;
  const std::string pieces = text.substr(begin, end - begin);
  for (int i = 0; i < 3; ++i) text.insert(end, pieces);
  refuse("a.vtu", text, {"line", "overlaps"});
}

TEST_F(RefuseMesh, LegacyVtk) {
  const std::string text = legacy_vtk_text(mesh_, false, false);
  const auto edited = [&](const char* old, const char* now, const Words& words) {
    refuse_edited("a.vtk", text, old, now, words);
  };
  edited("# vtk", "# vtq", {"line 1"});
  edited("ASCII", "EBCDIC", {"line 3", "neither ASCII nor BINARY"});
  edited("UNSTRUCTURED_GRID", "POLYDATA", {"line 4", "UNSTRUCTURED_GRID"});
  edited("POINTS 6", "POINTS -6", {"line 5", "negative"});
  edited("POINTS 6", "POINTS 99999999999", {"line 5", "more than"});
  edited("POINTS 6", "POINTS 99999999999999999999", {"line 5", "out of range"});
  edited("POINTS 6", "POINTS 5", {"is not a keyword"});
  edited("POINTS 6 double", "POINTS 6 quad", {"line 5", "'QUAD' is not a type"});
  edited("CELLS 5", "CELLS 4", {"line 11", "CELL_DATA of 5 cells, the grid has 4"});
  edited("CELL_TYPES 5", "CELL_TYPES 4", {"is not a keyword"});
  edited("CELL_DATA 5", "CELL_DATA 6", {"6 cells, the grid has 5"});
  edited("\n3 0 1 2 ", "\n-3 0 1 2 ", {"cell 0", "run past"});
  const std::string binary = legacy_vtk_text(mesh_, true, true);
  refuse_edited("a.vtk", binary, "POINTS 6", "POINTS 9000", {"byte", "more than"});
  refuse_edited("a.vtk", binary, "POINTS 6", "POINTS 60", {"byte", "the file ends within"});
}

TEST_F(RefuseMesh, MeditText) {
  const std::string text = medit_text(mesh_);
  const auto edited = [&](const char* old, const char* now, const Words& words) {
    refuse_edited("a.mesh", text, old, now, words);
  };
  edited("Dimension 3", "Dimension 2", {"line 2", "not 3"});
  edited("Vertices\n6", "Vertices\n-1", {"line 4", "negative"});
  edited("Vertices\n6", "Vertices\n6000000000", {"line 4", "more than"});
  edited("Vertices\n6", "Vertices\n7", {"line 11", "'Corners' is not a number"});
  edited("Vertices\n6", "Vertices\n5", {"line 10", "stands where a keyword"});
  edited("Tetrahedra\n3", "Tetrahedra\nthree", {"line", "'three' is not a number"});
  edited("Vertices", "Voices", {"Vertices", "no such section"});
  edited("End", "", {"the file ends"});
}

TEST_F(RefuseMesh, MeditBinary) {
  const std::string bytes = medit_bytes(mesh_, 2, false);
  const auto with_int = [&](std::size_t position, std::int32_t number) {
    Bytes written(false);
    written.put(number);
    return std::string(bytes).replace(position, 4, written.text);
  };
  refuse("a.meshb", with_int(0, 2), {"byte 0", "first number"});
  refuse("a.meshb", with_int(4, 9), {"byte 4", "version 9"});
  refuse("a.meshb", with_int(12, 4), {"byte 12", "before it"});  // otherwise an endless loop
  refuse("a.meshb", with_int(16, 2), {"byte 16", "dimension"});
  refuse("a.meshb", with_int(24, 1 << 30), {"lies outside the file"});
  refuse("a.meshb", with_int(28, 1 << 30), {"byte 28", "more than"});
  refuse("a.meshb", with_int(28, -5), {"byte 28", "negative"});
  refuse("a.meshb", with_int(28, 7), {"runs past its end"});
}

TEST_F(RefuseMesh, Gmsh) {
  const std::string v2 = gmsh_v2_text(mesh_), v4 = gmsh_v4_text(mesh_),
                    binary = gmsh_v4_bytes(mesh_, 8, false);
  refuse_edited("a.msh", v2, "2.2 0 8", "3.0 0 8", {"line 2", "'3.0'"});
  refuse_edited("a.msh", v4, "4.1 0 8", "4.0 0 8", {"line 2", "'4.0'"});
  refuse_edited("a.msh", v4, "4.1 0 8", "4.1 0 2", {"line 2", "numbers of 2 bytes"});
  refuse_edited("a.msh", v2, "\n2 ", "\n1 ", {"$Nodes", "node tag 1 is given twice"});
  refuse_edited("a.msh", v2, "$Nodes\n6", "$Nodes\n-6", {"line 5", "negative"});
  refuse_edited("a.msh", v2, "$Nodes\n6", "$Nodes\n7", {"line 12", "is not a number"});
  refuse_edited("a.msh", v2, "$Nodes\n6", "$Nodes\n5", {"line 11", "not closed"});
  refuse_edited("a.msh", v2, "9 2 2", "9 999 2", {"line 15", "type 999"});
  refuse_edited("a.msh", v2, "9 2 2", "9 2 -2", {"line 15", "negative"});
  refuse_edited("a.msh", v2, "$Elements", "$Nothing", {"without its end"});
  refuse_edited("a.msh", v4, "1 6 1 6\n", "1 7 1 6\n", {"6 nodes, 7 are announced"});
  refuse_edited("a.msh", v4, "4 5 1 9\n", "4 9 1 9\n", {"5 elements, 9 are announced"});
  refuse_edited("a.msh", v4, "$EndMeshFormat", "$EndMeshFormat\n$Elements\n$EndElements", {"before $Nodes"});
  const std::string nodes = "$Nodes\n" + std::string("\1\0\0\0\0\0\0\0", 8);
  refuse_edited("a.msh", binary, nodes, "$Nodes\n\xff\xff\xff\xff\xff\xff\xff\xff", {"byte", "more than"});
  refuse_edited("a.msh", binary, std::string("\n\1\0\0\0", 5), "\nabcd", {"byte", "mark of the byte order"});
}

TEST_F(RefuseMesh, Tetgen) {
  const auto nodes = tetgen_nodes(mesh_, 1), elements = tetgen_elements(mesh_, 1),
             faces = tetgen_faces(mesh_, 1);
  write_bytes(folder_ / "alone.node", nodes);
  EXPECT_NE(refusal_of(folder_ / "alone.node").find("alone.ele: no such file"), std::string::npos);
  write_bytes(folder_ / "a.ele", elements);
  refuse_edited("a.node", nodes, "6 3 1", "6 2 1", {"line 2", "dimension"});
  refuse_edited("a.node", nodes, "6 3 1", "66666666 3 1", {"line 2", "more than"});
  refuse_edited("a.node", nodes, "  3 ", "  4 ", {"line 5", "number 4 where 3 is expected"});
  refuse_edited("a.node", nodes, "16777216", "abc", {"line 6", "'abc' is not a number"});
  refuse("a.node", nodes.substr(0, 60), {"line", "the file ends"});
  write_bytes(folder_ / "a.node", nodes);
  refuse_edited("a.ele", elements, "3 4 1", "3 5 1", {"line 1", "5 nodes"});
  refuse_edited("a.ele", elements, "3 4 1", "-3 4 1", {"line 1", "negative"});
  refuse_edited("a.ele", elements, "3 4 1", "4 4 1", {"line", "the file ends"});
  write_bytes(folder_ / "a.ele", elements);
  write_bytes(folder_ / "a.face", faces.substr(0, 9));
  const std::string message = refusal_of(folder_ / "a.ele");
  EXPECT_TRUE(message.starts_with(folder_ / "a.face: line")) << message;
}

}  // namespace
}  // namespace podm::verify
