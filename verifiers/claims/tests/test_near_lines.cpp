#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <set>

#include "claims/near_lines.h"
#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

const double kLeastNearLinesDeg = std::asin(std::sqrt(0.125)) * 180 / std::numbers::pi;  // 20.7

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Options keeping_lines() {
  Options options = two_threads();
  options.lines_delta_mm = 1;
  return options;
}

ClaimResult angles_of(const Mesh& mesh, const Options& options) {
  return check_boundary_angles(mesh, find_adjacency(mesh, 2), options);
}

// Returns three cells of different labels around an edge of length 2. The three facets that have the edge
// have a third vertex at `distance` from it, all other facets have larger angles.
Mesh three_labels_around_an_edge(double distance) {
  Mesh mesh = mesh_of({{0, 0, -1}, {0, 0, 1}}, {{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 2}});
  for (const double turn : {0.0, 120.0, 240.0})
    mesh.vertices.push_back({distance * std::cos(radians(turn)), distance * std::sin(radians(turn)), 0});
  mesh.cell_labels = {1, 2, 3};
  return mesh;
}

Mesh three_labels_with_angle(double degrees) {
  return three_labels_around_an_edge(std::tan(radians(degrees)));
}

// Returns a cell of label 1 with a boundary facet whose least angle this is.
Mesh cell_with_angle(double degrees) {
  const double t = radians(degrees);
  Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {std::cos(t), std::sin(t), 0}, {0.6, 0.2, 0.6}}, {{0, 1, 2, 3}});
  mesh.cell_labels = {1};
  return mesh;
}

TEST(NearLines, FacetsOfLineEdgesHaveASmallerBound) {
  const Mesh mesh = three_labels_with_angle(25);
  const ClaimResult strict = angles_of(mesh, two_threads());
  EXPECT_EQ(strict.num_violations, 3U);
  EXPECT_FALSE(strict.details().contains("near_lines"));
  const ClaimResult result = angles_of(mesh, keeping_lines());
  EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
  const auto& near = result.details()["near_lines"];
  EXPECT_EQ(near["facets"], 9);
  EXPECT_EQ(near["excused"], 3);
  EXPECT_NEAR(near["smallest_degrees"].get<double>(), 25, 1e-9);
  EXPECT_NEAR(near["bound_degrees"].get<double>(), kLeastNearLinesDeg, 1e-9);
  EXPECT_NE(result.reason.find("near lines 20.7"), std::string::npos) << result.reason;
}

TEST(NearLines, ThePromiseOfAFileIsEnough) {
  Mesh mesh = three_labels_with_angle(25);
  mesh.promised_lines_delta_mm = 1;
  EXPECT_EQ(angles_of(mesh, two_threads()).verdict, Verdict::kPass);
}

TEST(NearLines, SmallerAnglesThanTheirBoundAreViolations) {
  const ClaimResult result = angles_of(three_labels_with_angle(20), keeping_lines());
  EXPECT_EQ(result.num_violations, 3U);
  EXPECT_TRUE(names(result, "angles exceed the bound near lines"));
  EXPECT_EQ(result.details()["near_lines"]["excused"], 0);
}

// Two neighbouring doubles have the angle whose squared sine is 1/8 between them.
TEST(NearLines, TheBoundIsDecidedExactly) {
  double low = 0.1, high = 0.5;  // distances: violation, none
  const auto holds = [](double distance) {
    return angles_of(three_labels_around_an_edge(distance), keeping_lines()).num_violations == 0;
  };
  ASSERT_FALSE(holds(low));
  ASSERT_TRUE(holds(high));
  while (std::nextafter(low, high) < high) {
    const double middle = low + 0.5 * (high - low);
    (holds(middle) ? high : low) = middle;
  }
  EXPECT_NEAR(high, 1 / std::sqrt(7.0), 1e-15);
}

TEST(NearLines, NoFacetElsewhereIsExcused) {
  Mesh mesh = joined(three_labels_with_angle(25), shifted(cell_with_angle(25), {5, 0, 0}));
  mesh.cell_labels = {1, 2, 3, 1};
  const ClaimResult result = angles_of(mesh, keeping_lines());
  EXPECT_EQ(result.num_violations, 1U);
  EXPECT_EQ(result.bad_cells, std::vector<GlobalId>{3});
  EXPECT_TRUE(names(result, "angles exceed the bound"));
  EXPECT_EQ(result.details()["near_lines"]["facets"], 9);
}

TEST(NearLines, ALowerBoundHoldsThereToo) {
  Options options = keeping_lines();
  options.angle_bound_deg = 15;
  const ClaimResult result = angles_of(three_labels_with_angle(17), options);
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_EQ(result.details()["near_lines"]["bound_degrees"], 15);
  EXPECT_EQ(result.details()["near_lines"]["excused"], 0);
}

// Finds the ends of edges with three labels around them among all cells and boundary facets of each edge.
std::set<VertexId> ends_by_force(const Mesh& mesh, const Adjacency& adjacency) {
  std::map<std::array<VertexId, 2>, std::set<LabelValue>> labels_of;
  const auto add = [&](VertexId a, VertexId b, LabelValue label) {
    labels_of[{std::min(a, b), std::max(a, b)}].insert(label);
  };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    for (const auto& [i, j] : kEdges)
      add(mesh.cells[c][static_cast<std::size_t>(i)], mesh.cells[c][static_cast<std::size_t>(j)],
          mesh.cell_labels[c]);
    for (FacetId f = static_cast<FacetId>(4 * c); f < 4 * c + 4; ++f) {
      if (adjacency.mirror[f] != kNone) continue;
      const auto v = vertices_of(mesh, f);
      for (std::size_t i = 0; i < 3; ++i) add(v[i], v[(i + 1) % 3], 0);
    }
  }
  std::set<VertexId> ends;
  for (const auto& [edge, labels] : labels_of)
    if (labels.size() >= 3) ends.insert(edge.begin(), edge.end());
  return ends;
}

template <class Vertices>
bool has_any(const std::set<VertexId>& ends, const Vertices& vertices) {
  return std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) { return ends.contains(v); });
}

Mesh random_labels(unsigned seed) {
  std::mt19937 random(seed);
  std::discrete_distribution<int> label({1, 8, 1, 1});
  Mesh mesh = kuhn_mesh(make_image({5, 4, 3}, kUnitAffine,
                                   [&](int, int, int) { return static_cast<std::uint32_t>(label(random)); }));
  for (LabelValue& value : mesh.cell_labels)
    if (random() % 100 == 0) value = 0;
  return mesh;
}

TEST(NearLines, AreTheFacetsAndCellsAtEdgesWithThreeLabels) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Mesh mesh = random_labels(seed);
    const Adjacency adjacency = mapped_adjacency(mesh);
    const std::set<VertexId> ends = ends_by_force(mesh, adjacency);
    const NearLines near_lines(mesh, adjacency, keeping_lines());
    for (VertexId v = 0; v < mesh.vertices.size(); ++v)
      EXPECT_EQ(near_lines.has(std::array{v}), ends.contains(v)) << seed << " " << v;
    const auto num_cells = std::count_if(mesh.cells.begin(), mesh.cells.end(),
                                         [&](const auto& cell) { return has_any(ends, cell); });
    EXPECT_GT(num_cells, 0);
    EXPECT_LT(num_cells, static_cast<std::ptrdiff_t>(mesh.cells.size()));
    const ClaimResult ratios = check_radius_edge(mesh, adjacency, keeping_lines());
    EXPECT_EQ(ratios.details()["near_lines"]["cells"], num_cells);
  }
}

TEST(NearLines, NothingIsNearLinesThatAreNotKept) {
  const Mesh mesh = three_labels_with_angle(25);
  const Adjacency adjacency = mapped_adjacency(mesh);
  const NearLines near_lines(mesh, adjacency, two_threads());
  EXPECT_FALSE(near_lines.are_kept());
  EXPECT_FALSE(near_lines.has(mesh.cells[0]));
  EXPECT_FALSE(check_radius_edge(mesh, adjacency, two_threads()).details().contains("near_lines"));
}

TEST(NearLines, AMeshWithoutLabelsHasNone) {
  Mesh mesh = three_labels_with_angle(25);
  mesh.cell_labels.clear();
  const NearLines near_lines(mesh, mapped_adjacency(mesh), keeping_lines());
  EXPECT_TRUE(near_lines.are_kept());
  EXPECT_FALSE(near_lines.has(mesh.cells[0]));
}

TEST(NearLines, TheRadiusEdgeBoundHoldsThereToo) {
  Options options = keeping_lines();
  const Mesh mesh = three_labels_with_angle(25);
  const double largest =
      check_radius_edge(mesh, mapped_adjacency(mesh), options).details()["near_lines"]["largest_ratio"];
  options.radius_edge_bound = largest + 1e-9;
  EXPECT_EQ(check_radius_edge(mesh, mapped_adjacency(mesh), options).verdict, Verdict::kPass);
  options.radius_edge_bound = largest - 1e-9;
  EXPECT_EQ(check_radius_edge(mesh, mapped_adjacency(mesh), options).verdict, Verdict::kFail);
}

}  // namespace
}  // namespace podm::verify
