// The surface of each label is closed, faces outwards and encloses the volume of the label's cells.
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "io/tests/kuhn_mesh.h"
#include "io/tests/mesh_readers.h"
#include "podm/mesh_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

using Coordinates = std::array<double, 3>;

bool is_closed(const Triangles& triangles) {
  std::map<std::pair<Coordinates, Coordinates>, int> balance;
  for (const auto& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      const Coordinates &from = t[i], &to = t[(i + 1) % 3];
      from < to ? ++balance[{from, to}] : --balance[{to, from}];
    }
  }
  for (const auto& [edge, sum] : balance)
    if (sum != 0) return false;
  return !triangles.empty();
}

double enclosed_volume(const Triangles& triangles) {
  double sum = 0;
  const Coordinates apex = triangles.front()[0];
  for (const auto& [a, b, c] : triangles) sum -= six_volumes(a, b, c, apex) / 6;
  return sum;
}

TEST(Surfaces, AreClosedOutwardAndEncloseTheVolumeOfTheLabel) {
  const ScratchFolder folder;
  const TetMesh mesh = shuffled(make_test_mesh(7), 2);
  write_surfaces(mesh, folder / "s.ply");
  write_surfaces(mesh, folder / "s.stl");
  const std::vector<std::string> stems{"", "s_7_liver", "s_3000000000", "s_2_left_kidney_2"};
  std::set<std::string> expected_files;
  for (LabelIndex label = 1; label < stems.size(); ++label) {
    for (const std::string extension : {".ply", ".stl"}) expected_files.insert(stems[label] + extension);
    const Triangles ply = read_ply(folder / (stems[label] + ".ply"));
    const Triangles stl = read_stl(folder / (stems[label] + ".stl"));
    const double volume = volume_of_label(mesh, label);
    ASSERT_GT(volume, 0);
    EXPECT_TRUE(is_closed(ply)) << stems[label];
    EXPECT_TRUE(is_closed(stl)) << stems[label];
    EXPECT_NEAR(enclosed_volume(ply), volume, 1e-9 * volume);
    EXPECT_NEAR(enclosed_volume(stl), volume, 1e-4 * volume);  // single precision
    EXPECT_EQ(ply.size(), stl.size());
  }
  EXPECT_EQ(folder.files(), expected_files);
}

TEST(Surfaces, StlNormalsAgreeWithTheVertices) {
  const ScratchFolder folder;
  write_surfaces(make_test_mesh(), folder / "s.stl");
  const std::string bytes = read_bytes(folder / "s_7_liver.stl");
  EXPECT_NE(bytes.substr(0, 5), "solid");  // this word would announce an ascii file
  const Triangles triangles = read_stl(folder / "s_7_liver.stl");
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::array<float, 3> normal;
    std::memcpy(&normal, bytes.data() + 84 + 50 * i, sizeof(normal));
    const auto& [a, b, c] = triangles[i];
    const Coordinates apex{a[0] + normal[0], a[1] + normal[1], a[2] + normal[2]};
    EXPECT_GT(six_volumes(a, b, c, apex), 0);
    EXPECT_NEAR(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2], 1, 1e-5);
  }
}

}  // namespace
}  // namespace podm
