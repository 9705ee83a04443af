// Meshes with a flat box: their boundary at the image's border lies in the planes of its sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "algorithms/check_options.h"
#include "geometry/affine.h"
#include "geometry/predicates.h"
#include "podm/mesh_image.h"
#include "podm/mesh_io.h"
#include "run/mend_turned_cells.h"
#include "tests/fault_of.h"
#include "tests/images.h"

namespace podm::test {
namespace {

MeshingOptions flat(double radius_mm, double delta_mm) {
  MeshingOptions options;
  options.sizes.radius_mm = radius_mm;
  options.sizes.delta_mm = delta_mm;
  options.box = BoxFaces::kFlat;
  options.team.threads = 1;
  return options;
}

LabelImage flat(LabelImage image) {
  image.is_box_flat = true;
  return image;
}

// A block that two labels fill, with an interface at an angle.
LabelImage filled_block() {
  return flat(make_image({12, 10, 9}, {1, 1, 1}, 2,
                         [](int i, int j, int k) { return i + 0.4 * j - 0.3 * k < 6 ? 1 : 2; }));
}

// A ball that all sides but one cut, and a second one in a corner.
LabelImage cut_balls() {
  return flat(make_image({14, 13, 12}, {1, 1.1, 0.9}, 2, [](int i, int j, int k) {
    if (std::hypot(i - 13, 1.1 * j - 14, 0.9 * k) < 6) return 2;
    return std::hypot(i - 5.0, 1.1 * j - 5, 0.9 * k - 5) < 7 ? 1 : 0;
  }));
}

LabelImage small_block(int n) {
  return flat(make_image({2, n, 1 + n % 2}, {1, 1, 1}, 2,
                         [&](int i, int j, int) { return j > n / 2 ? 1 : (i + j) % 3; }));
}

std::set<std::array<std::uint32_t, 2>> edges_on(const TetMesh& mesh, SideMask sides) {
  std::set<std::array<std::uint32_t, 2>> edges;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    if (side_of_facet(mesh, f) == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = mesh.facets[f][i], b = mesh.facets[f][(i + 1) % 3];
      if ((mesh.vertex_sides[a] & mesh.vertex_sides[b] & sides) == sides)
        edges.insert({std::min(a, b), std::max(a, b)});
    }
  }
  return edges;
}

double length_of(const TetMesh& mesh, const std::set<std::array<std::uint32_t, 2>>& edges) {
  double sum = 0;
  for (const auto& [a, b] : edges) {
    const auto &p = mesh.vertices[a], &q = mesh.vertices[b];
    sum += std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  }
  return sum;
}

double area_of(const TetMesh& mesh, SideMask side) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    if (side_of_facet(mesh, f) != side) continue;
    const auto at = [&](std::size_t i) {
      const auto& v = mesh.vertices[mesh.facets[f][i]];
      return Point{v[0], v[1], v[2]};
    };
    sum += 0.5 * std::sqrt(squared_length(cross(at(1) - at(0), at(2) - at(0))));
  }
  return sum;
}

// The distance of a vertex from the plane of a side in the world, mm.
double off_plane(const LabelImage& image, const std::array<double, 3>& vertex, std::size_t side) {
  const Point u = map(inverse(image.voxel_to_ras), Point{vertex[0], vertex[1], vertex[2]});
  const std::size_t a = side / 2;
  const double at = std::array{u.x, u.y, u.z}[a];
  return std::fabs(at - (side % 2 == 0 ? -0.5 : image.size[a] - 0.5)) * image.spacing[a];
}

void expect_flat(const LabelImage& image, const MeshingResult& made) {
  const TetMesh& mesh = made.mesh;
  EXPECT_TRUE(made.report.guarantees.all_met());
  EXPECT_EQ(made.report.guarantees.off_sides, 0);
  ASSERT_EQ(mesh.vertex_sides.size(), mesh.vertices.size());
  std::array<std::set<double>, kNumSides> coordinates;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (std::size_t side = 0; side < kNumSides; ++side)
      if ((mesh.vertex_sides[v] >> side & 1) != 0) {
        ASSERT_LT(off_plane(image, mesh.vertices[v], side), 1e-11);
      }
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    if (mesh.facet_labels[f][0] != kBackground) {
      ASSERT_EQ(side_of_facet(mesh, f), 0);
    }
  }
}

// The object fills the box: its boundary is the box, with all edges and corners.
TEST(FlatBoxOfMesh, IsTheBoxOfAFilledImage) {
  const LabelImage image = filled_block();
  constexpr double kDelta = 1.2;
  const MeshingResult made = mesh_image(image, flat(2.5, kDelta));
  expect_flat(image, made);
  const TetMesh& mesh = made.mesh;
  double volume = 0;
  for (const auto& [label, mm3] : made.report.volume_of_label_mm3) volume += mm3;
  EXPECT_NEAR(volume, 12 * 10 * 9, 1e-9 * volume);
  std::size_t on_sides = 0;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) on_sides += side_of_facet(mesh, f) != 0;
  EXPECT_EQ(on_sides, std::count_if(mesh.facet_labels.begin(), mesh.facet_labels.end(),
                                    [](const auto& pair) { return pair[0] == kBackground; }));
  const std::array<double, 3> length{12, 10, 9};
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = a + 1; b < 6; ++b) {
      if (a / 2 == b / 2) continue;
      const auto edge = static_cast<SideMask>(1u << a | 1u << b);
      const auto edges = edges_on(mesh, edge);
      EXPECT_NEAR(length_of(mesh, edges), length[3 - a / 2 - b / 2], 1e-9);
      // They are sampled before the sides: few facets on the sides cut them into shorter ones.
      EXPECT_GT(length_of(mesh, edges), 0.6 * kDelta * static_cast<double>(edges.size()));
    }
  for (std::size_t a = 0; a < 3; ++a) {
    const double face = length[(a + 1) % 3] * length[(a + 2) % 3];
    EXPECT_NEAR(area_of(mesh, static_cast<SideMask>(1u << 2 * a)), face, 1e-9);
    EXPECT_NEAR(area_of(mesh, static_cast<SideMask>(2u << 2 * a)), face, 1e-9);
  }
  const auto corners = std::count_if(mesh.vertex_sides.begin(), mesh.vertex_sides.end(),
                                     [](SideMask sides) { return std::popcount(sides) == 3; });
  EXPECT_EQ(corners, 8);
}

TEST(FlatBoxOfMesh, HoldsWhereTheObjectTouchesTheBorder) {
  const LabelImage image = cut_balls();
  for (const double delta : {0.8, 1.5}) {
    const MeshingResult made = mesh_image(image, flat(3, delta));
    expect_flat(image, made);
    EXPECT_TRUE(made.report.facets_of_sides);
    EXPECT_GT((*made.report.facets_of_sides)[0], 0);
  }
}

TEST(FlatBoxOfMesh, HoldsInAnyFrame) {
  for (const NamedAffine& frame : affines()) {
    LabelImage image = filled_block();
    image.voxel_to_ras = frame.affine;
    if (std::string(frame.name).find("sheared") != std::string::npos) {
      EXPECT_NE(fault_of<InputError>([&] { mesh_image(image, flat(2.5, 1.5)); }).find("sheared"),
                std::string::npos);
      continue;
    }
    const MeshingResult made = mesh_image(image, flat(2.5, 1.5));
    expect_flat(image, made);
    double volume = 0;
    for (const auto& [label, mm3] : made.report.volume_of_label_mm3) volume += mm3;
    EXPECT_NEAR(volume, 12 * 10 * 9, 1e-8 * volume) << frame.name;
  }
}

// In voxels, planes are half integers.
TEST(FlatBoxOfMesh, IsExactInVoxels) {
  LabelImage image = filled_block();
  for (const NamedAffine& frame : affines()) {
    if (std::string(frame.name).find("sheared") != std::string::npos) continue;
    image.voxel_to_ras = frame.affine;
    MeshingOptions options = flat(2.5, 1.5);
    options.space = Space::kVoxel;
    const TetMesh mesh = mesh_image(image, options).mesh;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      for (std::size_t side = 0; side < kNumSides; ++side)
        if ((mesh.vertex_sides[v] >> side & 1) != 0) {
          ASSERT_EQ(mesh.vertices[v][side / 2], side % 2 == 0 ? -0.5 : image.size[side / 2] - 0.5);
        }
  }
}

// Rounding inverts cells whose vertices lie in one plane across the image's axes; they are mended.
TEST(FlatBoxOfMesh, HasNoInvertedCellsInAnyFrame) {
  for (const NamedAffine& frame : affines()) {
    if (std::string(frame.name).find("sheared") != std::string::npos) continue;
    for (int n = 2; n < 8; ++n) {
      LabelImage image = small_block(n);
      image.voxel_to_ras = frame.affine;
      EXPECT_EQ(mesh_image(image, flat(0.9, 0.6)).report.guarantees.orientation, 0) << frame.name << n;
    }
  }
}

// True if no vertex is inside the sphere of a cell, and no cell is inverted.
bool is_delaunay(const TetMesh& mesh) {
  const auto point = [&](std::uint32_t v) {
    return Point{mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]};
  };
  return std::ranges::all_of(mesh.cells, [&](const auto& cell) {
    const Point a = point(cell[0]), b = point(cell[1]), c = point(cell[2]), d = point(cell[3]);
    if (orientation(a, b, c, d) <= 0) return false;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (std::ranges::find(cell, v) == cell.end() && in_circumsphere(a, b, c, d, point(v))) return false;
    return true;
  });
}

// In the small blocks many vertices are on one sphere.
TEST(FlatBoxOfMesh, ClaimsToBeDelaunayInObliqueFramesOnlyIfItIs) {
  int claimed = 0, unclaimed = 0;
  const auto judge = [&](LabelImage image, double delta) {
    for (const NamedAffine& frame : affines()) {
      if (std::string(frame.name).find("oblique") == std::string::npos) continue;
      image.voxel_to_ras = frame.affine;
      for (std::size_t at = 0; at < 12; ++at)
        if (at % 4 < 3) image.voxel_to_ras[at] *= image.spacing[at % 4];
      const MeshingResult made = mesh_image(image, flat(2.5 * delta, delta));
      ASSERT_TRUE(made.report.is_delaunay_when_turned);
      EXPECT_NE(*made.report.is_delaunay_when_turned, made.mesh.is_optimized);
      EXPECT_EQ(*made.report.is_delaunay_when_turned, is_delaunay(made.mesh)) << frame.name << delta;
      ++(made.mesh.is_optimized ? unclaimed : claimed);
    }
  };
  for (const double delta : {0.8, 1.1, 1.5, 2.0, 2.6}) {
    judge(filled_block(), delta);
    judge(cut_balls(), delta);
  }
  for (int n = 2; n < 10; ++n) judge(small_block(n), 0.6);
  EXPECT_GT(claimed, 0);
  EXPECT_GT(unclaimed, 0);
}

TEST(MendTurnedCells, MakesFlatCellsPositive) {
  LabelImage image = flat(make_image({3, 3, 3}, {1, 1, 1}, 1, [](int, int, int) { return 1; }));
  image.voxel_to_ras = {0.6, -0.8, 0, 0, 0.8, 0.6, 0, 0, 0, 0, 1, 0};
  TetMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 1}};
  mesh.vertex_sides.assign(5, 1 << 4);
  mesh.cells = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  const auto before = mesh.vertices;
  EXPECT_EQ(mend_turned_cells(mesh, image, 1), 1);
  EXPECT_EQ(mesh.vertices, before);  // no vertex may leave side k-
  mesh.vertex_sides[3] = 1 << 0 | 1 << 3;
  EXPECT_EQ(mend_turned_cells(mesh, image, 1), 1);
  EXPECT_GT(mesh.vertices[3][2], 0);
  EXPECT_NEAR(mesh.vertices[3][2], 0, 1e-12);
  mesh.vertices[3] = before[3];
  EXPECT_EQ(mesh.vertices, before);
}

// In frames that are permuted or mirrored all vertices on a side have one coordinate.
TEST(FlatBoxOfMesh, IsExactInPermutedFrames) {
  LabelImage image = filled_block();
  image.voxel_to_ras = {0, -1, 0, 5.3, -1, 0, 0, 6.7, 0, 0, -1, 7.1};
  const MeshingResult made = mesh_image(image, flat(2.5, 1.5));
  constexpr std::array<std::size_t, 3> kRows{1, 0, 2};
  std::array<std::set<double>, kNumSides> coordinates;
  for (std::size_t v = 0; v < made.mesh.vertices.size(); ++v)
    for (std::size_t side = 0; side < kNumSides; ++side)
      if ((made.mesh.vertex_sides[v] >> side & 1) != 0)
        coordinates[side].insert(made.mesh.vertices[v][kRows[side / 2]]);
  for (const auto& of_side : coordinates) EXPECT_EQ(of_side.size(), 1);
}

TEST(FlatBoxOfMesh, HoldsForAllAlgorithmsAndOptions) {
  const LabelImage image = cut_balls();
  MeshingOptions options = flat(2.5, 1.3);
  for (const Algorithm algorithm :
       {Algorithm::kPodm, Algorithm::kPdr, Algorithm::kPdrPodm, Algorithm::kPodmHome}) {
    options.algorithm = algorithm;
    options.team.threads = 2;
    expect_flat(image, mesh_image(image, options));
  }
  options = flat(2.5, 1.3);
  options.smoothing_mm = 1.5;
  expect_flat(image, mesh_image(image, options));
  options = flat(2.5, 1.3);
  options.min_dihedral_deg = 10;
  expect_flat(image, mesh_image(image, options));
  options.min_dihedral_deg = 0;
  options.optimize.is_wanted = true;
  expect_flat(image, mesh_image(image, options));
}

std::vector<std::array<std::uint32_t, 2>> edges_between(const TetMesh& mesh,
                                                        const std::vector<LabelIndex>& labels) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t e = 0; e < mesh.lines.edges.size(); ++e)
    if (mesh.lines.labels_of_line[mesh.lines.line_of_edge[e]] == labels) edges.push_back(mesh.lines.edges[e]);
  return edges;
}

// The interface of the block meets the sides along one closed line.
TEST(FlatBoxOfMesh, HasLinesWhereAnInterfaceMeetsItsSides) {
  const LabelImage image = filled_block();
  for (const double smoothing_mm : {0.0, 1.2}) {
    MeshingOptions options = flat(2.5, 1.2);
    options.lines.are_kept = true;
    options.smoothing_mm = smoothing_mm;
    const MeshingResult made = mesh_image(image, options);
    expect_flat(image, made);
    EXPECT_TRUE(made.report.lines->is_claimed());
    EXPECT_EQ(made.report.lines->stray_mm, 0);
    const TetMesh& mesh = made.mesh;
    const auto edges = edges_between(mesh, {0, 1, 2});
    EXPECT_EQ(edges.size(), mesh.lines.edges.size());
    EXPECT_GT(edges.size(), 25u);
    std::map<std::uint32_t, int> degree;
    for (const auto& edge : edges) {
      EXPECT_NE(mesh.vertex_sides[edge[0]] & mesh.vertex_sides[edge[1]], 0);
      for (const std::uint32_t v : edge) ++degree[v];
    }
    for (const auto& [v, count] : degree) EXPECT_EQ(count, 2);
    EXPECT_EQ(degree.size(), edges.size());
  }
}

// A line of three labels inside ends at two sides, in vertices of three lines on each side.
TEST(FlatBoxOfMesh, HasLinesThatEndAtItsSides) {
  const LabelImage image = flat(make_image({11, 12, 10}, {1, 1, 1}, 3, [](int i, int j, int k) {
    const double x = i - 4.7 - 0.2 * k, y = j - 6.2 + 0.1 * k;
    return x < 0 ? 1 : y < 0.3 * x ? 2 : 3;
  }));
  MeshingOptions options = flat(2.5, 1.2);
  options.lines.are_kept = true;
  const MeshingResult made = mesh_image(image, options);
  expect_flat(image, made);
  EXPECT_TRUE(made.report.lines->is_claimed());
  const TetMesh& mesh = made.mesh;
  std::map<std::uint32_t, int> inside, on_sides;
  for (std::size_t e = 0; e < mesh.lines.edges.size(); ++e) {
    const bool is_inside = mesh.lines.labels_of_line[mesh.lines.line_of_edge[e]].front() != kBackground;
    for (const std::uint32_t v : mesh.lines.edges[e]) ++(is_inside ? inside : on_sides)[v];
  }
  int num_ends = 0;
  for (const auto& [v, count] : inside) {
    if (count == 2) continue;
    EXPECT_EQ(count, 1);
    EXPECT_EQ(std::popcount(mesh.vertex_sides[v]), 1);
    EXPECT_EQ(on_sides[v], 3);
    ++num_ends;
  }
  EXPECT_EQ(num_ends, 2);
}

TEST(FlatBoxOfMesh, HoldsWithLinesForAllAlgorithms) {
  const LabelImage image = cut_balls();
  MeshingOptions options = flat(2.5, 1.3);
  options.lines.are_kept = true;
  for (const Algorithm algorithm :
       {Algorithm::kPodm, Algorithm::kPdr, Algorithm::kPdrPodm, Algorithm::kPodmHome}) {
    options.algorithm = algorithm;
    options.team.threads = 2;
    expect_flat(image, mesh_image(image, options));
  }
  options.min_dihedral_deg = 10;
  expect_flat(image, mesh_image(image, options));
}

TEST(FlatBoxOfMesh, HoldsInALayerOfOneVoxel) {
  const LabelImage image = flat(
      make_image({14, 11, 1}, {1, 1, 2}, 2, [](int i, int j, int) { return i + j > 4 ? 1 + (i > 7) : 0; }));
  expect_flat(image, mesh_image(image, flat(3, 1)));
  expect_flat(image, mesh_image(image, flat(3, 0)));
}

// Noise has features of all sizes, many of them near two sides.
TEST(FlatBoxOfMesh, HoldsForNoise) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    const LabelImage image = flat(make_image({7, 6, 5}, {1, 1 + 0.1 * (seed % 4), 1 - 0.2 * (seed % 3)}, 3,
                                             [&](int, int, int) { return static_cast<int>(random() % 4); }));
    for (const bool has_lines : {false, true}) {
      MeshingOptions options = flat(2, 0.6);
      options.lines.are_kept = has_lines;
      EXPECT_EQ(mesh_image(image, options).report.guarantees.off_sides, 0) << seed;
    }
  }
}

TEST(FlatBoxOfMesh, IsTheSameAgain) {
  const LabelImage image = cut_balls();
  TetMesh first = mesh_image(image, flat(2.5, 1.3)).mesh, second = mesh_image(image, flat(2.5, 1.3)).mesh;
  canonicalize(first);
  canonicalize(second);
  EXPECT_EQ(mesh_sha256(first), mesh_sha256(second));
  EXPECT_EQ(first.vertex_sides, second.vertex_sides);
}

TEST(FlatBoxOfMesh, NeedsTheImageToAgree) {
  LabelImage image = filled_block();
  image.is_box_flat = false;
  EXPECT_NE(fault_of<InputError>([&] { mesh_image(image, flat(2.5, 1.5)); }), "no error");
}

}  // namespace
}  // namespace podm::test
