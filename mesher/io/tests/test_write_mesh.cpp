// Medit and Gmsh files read back to the mesh that was written. A mesh that cannot be written is refused and
// leaves no file.
#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <sstream>

#include "io/tests/kuhn_mesh.h"
#include "io/tests/mesh_readers.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"
#include "tests/fault_of.h"
#include "tests/full_disk.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

const std::vector<std::string> kNames{"", "liver", "label 3000000000", "left kidney/2"};

std::vector<std::string> names_of(const std::vector<Label>& labels) {
  std::vector<std::string> names;
  for (const Label& label : labels) names.push_back(label.name);
  names[0].clear();
  return names;
}

class EverySpace : public testing::TestWithParam<Space> {
 protected:
  TetMesh make_mesh() const {
    TetMesh mesh = make_test_mesh();
    add_lines(mesh);
    mesh.space = GetParam();
    canonicalize(mesh);
    return mesh;
  }
  const ScratchFolder folder_;
};

TEST_P(EverySpace, MeditRoundTrip) {
  const TetMesh mesh = make_mesh();
  write_mesh(mesh, folder_ / "a.mesh");
  const TetMesh read = read_medit(folder_ / "a.mesh");
  EXPECT_TRUE(same_mesh(read, mesh));
  EXPECT_EQ(names_of(read.labels), kNames);
}

TEST_P(EverySpace, GmshRoundTrip) {
  const TetMesh mesh = make_mesh();
  write_mesh(mesh, folder_ / "a.msh");
  const GmshFile read = read_gmsh(folder_ / "a.msh");
  EXPECT_TRUE(same_mesh(read.mesh, mesh));
  EXPECT_EQ(names_of(read.mesh.labels), kNames);
}

INSTANTIATE_TEST_SUITE_P(Spaces, EverySpace, testing::Values(Space::kRas, Space::kLps, Space::kVoxel),
                         [](const auto& instance) { return to_string(instance.param); });

// Exactly the surfaces that hold a volume's label bound it, with the sign of its side.
TEST(GmshFile, SurfacesOfVolumesAreSignedByTheirSide) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  write_mesh(mesh, folder / "a.msh");
  const GmshFile read = read_gmsh(folder / "a.msh");
  ASSERT_EQ(read.surfaces_of_volume.size(), 3u);
  std::set<std::array<LabelIndex, 2>> pairs;
  for (const auto& pair : mesh.facet_labels) {
    pairs.insert(pair);
    if (pair[0] != kBackground) pairs.insert({pair[1], pair[0]});
  }
  std::size_t num_surfaces = 0;
  for (const auto& [label, surfaces] : read.surfaces_of_volume) {
    num_surfaces += surfaces.size();
    for (const auto& pair : surfaces) {
      EXPECT_EQ(pair[1], label);  // the side that the normal points out of
      EXPECT_TRUE(pairs.count(pair));
    }
  }
  EXPECT_EQ(num_surfaces, pairs.size());
}

// Gmsh's tags are positive ints; physical groups have the label values if these fit.
TEST(GmshFile, PhysicalGroupsAreTheLabelValuesWhereTheyFit) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  mesh.labels[2].value = 40;
  write_mesh(mesh, folder / "a.msh");
  const std::string text = read_bytes(folder / "a.msh");
  for (const char* line : {"\n3 7 \"liver\"\n", "\n3 40 \"label 40\"\n", "\n3 2 \"left kidney/2\"\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
  EXPECT_TRUE(same_mesh(read_gmsh(folder / "a.msh").mesh, mesh));
}

TEST(MeshFiles, LabelNamesAreMadePrintableAndDistinct) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  const auto expect_names = [&](const std::array<std::string, 3>& given,
                                const std::array<std::string, 3>& expected) {
    for (int i = 0; i < 3; ++i) mesh.labels[i + 1].name = given[i];
    write_mesh(mesh, folder / "a.msh");
    write_mesh(mesh, folder / "a.mesh");
    const std::vector<std::string> names{"", expected[0], expected[1], expected[2]};
    EXPECT_EQ(names_of(read_gmsh(folder / "a.msh").mesh.labels), names);
    EXPECT_EQ(names_of(read_medit(folder / "a.mesh").labels), names);
  };
  expect_names({"a \"b\"|\nc", "outside", "a 'b'/ c"}, {"a 'b'/ c", "outside 3000000000", "a 'b'/ c 2"});
  expect_names({"b\xc3\xb8rn", "\xe8\x82\x9d", "\xf0\x9f\xab\x80"},  // valid UTF-8 is kept
               {"b\xc3\xb8rn", "\xe8\x82\x9d", "\xf0\x9f\xab\x80"});
  expect_names({"m\xf8r", "cut \xe8\x82", "over\xc1\xa1long"},  // Latin-1, truncated, overlong
               {"m?r", "cut ??", "over??long"});
  // Code points that are not characters.
  expect_names({"low \xed\xa0\x80", "non \xef\xbf\xbf", "big \xf4\x90\x80\x80"},
               {"low ???", "non ???", "big ????"});
}

TEST(MeshFiles, TheSameMeshGivesTheSameBytes) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  add_lines(mesh);
  TetMesh other = shuffled(mesh, 11);
  canonicalize(mesh);
  canonicalize(other);
  for (const char* extension : {".vtu", ".vtk", ".mesh", ".msh", ".xdmf", ".inp", ".e", ".ele"}) {
    write_mesh(mesh, folder / (std::string("a") + extension));
    write_mesh(other, folder / (std::string("b") + extension));
  }
  for (const char* ending : {".vtu", "_facets.vtu", "_lines.vtu", ".vtk", "_facets.vtk", ".mesh", ".msh",
                             ".h5", ".inp", ".e", ".node", ".ele", ".face"})
    EXPECT_EQ(read_bytes(folder / (std::string("a") + ending)),
              read_bytes(folder / (std::string("b") + ending)))
        << ending;
}

class NoSpace : public testing::TestWithParam<std::string> {};

TEST_P(NoSpace, KeepsTheOldFilesAndLeavesNoNewOnes) {
  const ScratchFolder folder;
  const std::string path = folder / GetParam();
  const TetMesh mesh = make_test_mesh(8);
  const bool is_surface = path.ends_with(".stl") || path.ends_with(".ply");
  const auto write = [&] { is_surface ? write_surfaces(mesh, path) : void(write_mesh(mesh, path)); };
  write();
  const std::set<std::string> names = folder.files();
  for (const std::string& name : names) folder.write(name, "old " + name);
  for (const rlim_t bytes : {0, 100, 6000}) {  // one file of several may still fit
    const FullDisk disk(bytes);
    EXPECT_EQ(fault_of<InputError>(write).find("cannot write " + (folder / "")), 0u) << bytes;
    EXPECT_EQ(folder.files(), names) << bytes;
    for (const std::string& name : names) EXPECT_EQ(folder.read(name), "old " + name);
  }
  write();
  for (const std::string& name : names) EXPECT_NE(folder.read(name), "old " + name);
}

INSTANTIATE_TEST_SUITE_P(Formats, NoSpace,
                         testing::Values("m.vtu", "m.vtk", "m.mesh", "m.msh", "m.xdmf", "m.inp", "m.e",
                                         "m.node", "m.stl", "m.ply"),
                         [](const auto& instance) { return instance.param.substr(2); });

TEST(CheckPath, AcceptsWhatCanBeWrittenAndLeavesNoTrace) {
  const ScratchFolder folder;
  for (const char* name :
       {"a.vtu", "a.vtk", "a.mesh", "a.msh", "a.xdmf", "a.inp", "a.e", "a.exo", "a.node", "a.ele"})
    EXPECT_NO_THROW(check_mesh_path(folder / name));
  for (const char* name : {"a.stl", "a.ply"}) EXPECT_NO_THROW(check_surface_path(folder / name));
  EXPECT_EQ(folder.files(), std::set<std::string>{});
}

TEST(CheckPath, RefusesUnknownExtensionsAndUnwritablePlaces) {
  const ScratchFolder folder;
  for (const std::string name : {"a", "a.", "a.vtp", "a.stl", ".vtu", "none/a.vtu"}) {
    const std::string path = folder / name;
    EXPECT_NE(fault_of<InputError>([&] { check_mesh_path(path); }).find(path), std::string::npos) << name;
    EXPECT_THROW(write_mesh(make_test_mesh(2), path), InputError);
  }
  for (const std::string name : {"a", "a.vtu", "a.obj", "none/a.stl"}) {
    const std::string path = folder / name;
    EXPECT_NE(fault_of<InputError>([&] { check_surface_path(path); }).find(path), std::string::npos) << name;
    EXPECT_THROW(write_surfaces(make_test_mesh(2), path), InputError);
  }
  EXPECT_EQ(folder.files(), std::set<std::string>{});
}

TEST(CheckPath, RefusesFilesThatHaveNoPlaceForWhatComesWithThem) {
  const ScratchFolder folder;
  for (const std::string name : {"a_facets.vtu", "b_facets.vtk", "c.h5", "d.face", "d.node"})
    std::filesystem::create_directory(folder / name);
  for (const std::string name : {"a.vtu", "b.vtk", "c.xdmf", "d.ele", "d.node"})
    EXPECT_THROW(check_mesh_path(folder / name), InputError) << name;
}

TEST(CheckPath, AVersionOfGmshIsForItsFilesAlone) {
  const ScratchFolder folder;
  const MeshFileOptions options{GmshVersion::k2_2};
  EXPECT_NO_THROW(check_mesh_path(folder / "a.msh", options));
  EXPECT_THROW(check_mesh_path(folder / "a.vtu", options), InputError);
}

// The formats that hold lines are those that the guide of lines names.
TEST(MeshFiles, AFormatThatHoldsNoLinesReportsTheirLoss) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  for (const bool has_lines : {false, true}) {
    if (has_lines) add_lines(mesh);
    for (const char* name : {"a.vtk", "a.node", "a.ele"}) {
      const std::vector<std::string> losses = write_mesh(mesh, folder / name);
      ASSERT_EQ(losses.size(), has_lines ? 1u : 0u) << name;
      for (const std::string& loss : losses) EXPECT_NE(loss.find("lines"), std::string::npos) << loss;
    }
  }
}

TEST(MeshFiles, AVtuFileReportsTheLinesOfAnotherMeshBesideIt) {
  const ScratchFolder folder;
  const TetMesh mesh = make_test_mesh();
  TetMesh with_lines = mesh;
  add_lines(with_lines);
  EXPECT_TRUE(write_mesh(mesh, folder / "a.vtu").empty());
  EXPECT_TRUE(write_mesh(with_lines, folder / "a.vtu").empty());
  EXPECT_EQ(write_mesh(mesh, folder / "a.vtu"),
            std::vector<std::string>{"a_lines.vtu beside it is of another mesh"});
  EXPECT_TRUE(write_mesh(with_lines, folder / "a.vtu").empty());
}

// Names of Abaqus sets consist of letters, digits, '_' and '-', have at most 80 characters, and ignore case.
TEST(AbaqusFile, NamesOfSetsAreMadeSafeAndDistinctAndReported) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  mesh.labels[1].name = "left kidney/2";
  mesh.labels[2].name = "LEFT kidney,2";
  mesh.labels[3].name = "4th " + std::string(100, 'x');
  const std::vector<std::string> losses = write_mesh(mesh, folder / "a.inp");
  ASSERT_EQ(losses.size(), 2u);
  EXPECT_NE(losses[0].find("3 labels"), std::string::npos) << losses[0];
  EXPECT_NE(losses[1].find("pairs of labels"), std::string::npos) << losses[1];
  std::set<std::string> names;
  std::istringstream lines(read_bytes(folder / "a.inp"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t place = line.find("ELSET=");
    if (line.starts_with("**") || place == std::string::npos) continue;
    std::string name = line.substr(place + 6);
    EXPECT_LE(name.size(), 80u);
    for (char& c : name) {
      EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-') << name;
      c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    EXPECT_TRUE(std::isalpha(static_cast<unsigned char>(name[0])) != 0) << name;
    EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
  }
  EXPECT_EQ(names.size(), 3u);
}

// CalculiX reads 20 characters of a number: a longer number would lose its exponent.
TEST(AbaqusFile, RealsHaveAtMostTwentyCharactersAndThatIsReported) {
  const ScratchFolder folder;
  TetMesh mesh = make_test_mesh();
  mesh.vertices[0] = {-1.2345678901234567e-5, 0.1, -123.45678901234567};
  mesh.vertices[1] = {-0.012345678901234567, 5e-324, -1.7976931348623157e308};
  const std::vector<std::string> losses = write_mesh(mesh, folder / "a.inp");
  ASSERT_FALSE(losses.empty());
  EXPECT_NE(losses.back().find("coordinates are rounded"), std::string::npos) << losses.back();
  const std::string text = read_bytes(folder / "a.inp");
  std::istringstream lines(text.substr(text.find("*NODE") + 17));
  for (const auto& vertex : mesh.vertices) {
    std::string field;
    std::getline(lines, field, ',');  // its number
    for (int axis = 0; axis < 3; ++axis) {
      std::getline(lines, field, axis < 2 ? ',' : '\n');
      field.erase(0, 1);
      EXPECT_LE(field.size(), 20u);
      EXPECT_NEAR(std::strtod(field.c_str(), nullptr) / vertex[axis], 1, 1e-12) << field;
    }
  }
}

}  // namespace
}  // namespace podm
