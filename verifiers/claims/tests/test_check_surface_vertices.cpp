#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "claims/check_labels_reach.h"
#include "claims/claims.h"
#include "claims/label_search.h"
#include "claims/lines_of_image.h"
#include "geometry/exact.h"
#include "image/smoothing.h"
#include "meshed_voxels.h"

namespace podm::verify {
namespace {

constexpr double kBound = 1e-5;
constexpr std::array<int, 3> kSize{13, 11, 9};

ClaimResult surface_vertices_of(const Mesh& mesh, const Image& image, double delta_mm = 100,
                                int threads = 2) {
  Options options;
  options.threads = threads;
  options.delta_mm = delta_mm;
  return check_surface_vertices(mesh, mapped_adjacency(mesh), image, options);
}

// Returns a point between a and b, whose labels differ, where the label changes, to about 1e-13 of a voxel's
// length.
Point change_between(const LabelFunction& function, Point a, Point b) {
  const std::uint32_t label = function.label_at(a);
  for (int i = 0; i < 48; ++i) {
    const Point middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    (function.label_at(middle) == label ? a : b) = middle;
  }
  return b;
}

// Returns cells that share no vertices; their vertices are points of the isosurface in every part of the
// image.
Mesh cells_on_isosurface(const Image& image, Space space, LabelValue label) {
  const LabelFunction function(image);
  const ImageFrame frame(image, space);
  std::mt19937 random(5);
  const auto somewhere = [&] {
    Point p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = std::uniform_real_distribution<double>(-0.9, image.size[axis] - 0.1)(random);
    return p;
  };
  Mesh mesh;
  mesh.space = space;
  while (mesh.vertices.size() < 400) {
    const Point a = somewhere(), b = somewhere();
    if (function.label_at(a) == function.label_at(b)) continue;
    mesh.vertices.push_back(frame.voxels_to_mesh(change_between(function, a, b)));
  }
  for (VertexId v = 0; v + 3 < mesh.vertices.size(); v += 4) {
    mesh.cells.push_back({v, v + 1, v + 2, v + 3});
    mesh.cell_labels.push_back(label);
  }
  return mesh;
}

// Returns a box of label 1 that fills the grid: its faces are planes half a voxel beyond the outermost
// centers.
Image full_box(const std::array<double, 12>& affine) {
  return make_image(kSize, affine, [](int, int, int) { return 1; });
}

// Returns a cell with a vertex on each of four faces of that box, the first moved off its face by `off`
// voxels.
Mesh cell_in_box(const Image& image, Space space, double off) {
  const ImageFrame frame(image, space);
  Mesh mesh;
  mesh.space = space;
  for (const Point& u : {Point{-0.5 - off, 4.3, 5.1}, Point{5, -0.5, 3}, Point{6, 10.5, 5}, Point{7, 4, 8.5}})
    mesh.vertices.push_back(frame.voxels_to_mesh(u));
  mesh.cells = {{0, 1, 2, 3}};
  mesh.cell_labels = {1};
  return mesh;
}

TEST(SurfaceVertices, AllPointsOfTheIsosurfaceAreOnIt) {
  for (const auto& affine : kAffines)
    for (const Space space : {Space::kRas, Space::kLps, Space::kVoxel})
      for (const bool is_smoothed : {false, true}) {
        Image image = make_image(kSize, affine, two_balls);
        if (is_smoothed) image.smoothing = smooth(image, 1.5 * image.spacing[0], 2);
        const ClaimResult result = surface_vertices_of(cells_on_isosurface(image, space, 1), image);
        EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
        EXPECT_EQ(result.details().at("vertices"), 400);
        EXPECT_LT(result.details().at("furthest_voxels").get<double>(), 1e-9);
        EXPECT_FALSE(result.worst.empty()) << "the closest calls";
      }
}

// Moves a point near a line to where the weights of three labels are equal, by Newton's method, which takes
// the shortest step. Returns nothing if other labels are greater there.
std::optional<Point> on_line(const LabelFunction& function, const LinePoint& near) {
  if (near.labels.size() != 3) return std::nullopt;
  const std::uint32_t a = near.labels[0], b = near.labels[1], c = near.labels[2];
  Point u = near.voxels;
  for (int i = 0; i < 8; ++i) {
    const LabelWeights w = function.weights_at(u);
    const std::array<double, 2> f{w.weight_of(a) - w.weight_of(b), w.weight_of(a) - w.weight_of(c)};
    const Point g = function.gradient_of_difference(u, a, b), h = function.gradient_of_difference(u, a, c);
    const double gg = dot(g, g), gh = dot(g, h), hh = dot(h, h), det = gg * hh - gh * gh;
    if (det < 0.01) return std::nullopt;
    const double s = (hh * f[0] - gh * f[1]) / det, t = (gg * f[1] - gh * f[0]) / det;
    for (std::size_t axis = 0; axis < 3; ++axis) u[axis] -= s * g[axis] + t * h[axis];
  }
  const LabelWeights w = function.weights_at(u);
  const double least = std::min({w.weight_of(a), w.weight_of(b), w.weight_of(c)});
  const double most = w.weights[w.best()];
  return most - least < 1e-14 ? std::optional(u) : std::nullopt;
}

// Returns cells that share no vertices; their vertices are points where three labels meet.
Mesh cells_on_lines(const Image& image, Space space) {
  const LabelFunction function(image);
  const ImageFrame frame(image, space);
  Mesh mesh;
  mesh.space = space;
  for (const LinePoint& point : lines_of_image(image, frame, 2))
    if (const auto u = on_line(function, point)) mesh.vertices.push_back(frame.voxels_to_mesh(*u));
  for (VertexId v = 0; v + 3 < mesh.vertices.size(); v += 4) {
    mesh.cells.push_back({v, v + 1, v + 2, v + 3});
    mesh.cell_labels.push_back(1);
  }
  return mesh;
}

TEST(SurfaceVertices, PointsWhereThreeLabelsMeetAreOnTheIsosurface) {
  for (const auto& affine : kAffines)
    for (const Space space : {Space::kRas, Space::kLps, Space::kVoxel})
      for (const bool is_smoothed : {false, true}) {
        std::mt19937 random(3);
        Image image = make_image({6, 5, 4}, affine, [&](int, int, int) { return random() % 5; });
        if (is_smoothed) image.smoothing = smooth(image, 0.8 * image.spacing[0], 2);
        const ClaimResult result = surface_vertices_of(cells_on_lines(image, space), image);
        EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
        EXPECT_GT(result.details().at("vertices"), 1000);
        EXPECT_LT(result.details().at("furthest_voxels").get<double>(), 1e-9);
      }
}

// Three cells of different labels around an edge on the line of their labels, which is parallel to the axis
// k. The weights between the voxels are 1 - x, x (1 - y) and x y: they are equal at x = 2/3, y = 1/2.
Mesh cells_around_a_line(const Image& image, double off) {
  const ImageFrame frame(image, Space::kRas);
  Mesh mesh;
  for (const Point& u : {Point{5 + 2.0 / 3 - off, 4.5, 3}, Point{5 + 2.0 / 3, 4.5, 3.7}, Point{5.5, 3.5, 3.2},
                         Point{5.5, 5.5, 3.2}, Point{7, 4.5, 3.2}})
    mesh.vertices.push_back(frame.voxels_to_mesh(u));
  mesh.cells = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 3, 4}};
  mesh.cell_labels = {1, 2, 3};
  return mesh;
}

TEST(SurfaceVertices, TheEndOfALineEdgeIsJudgedAsOthers) {
  const Image image = make_image(kSize, kUnitAffine, [](int i, int j, int) {
    return i < 6 ? 1 : j < 5 ? 2 : 3;
  });
  const auto at = [&](double off) { return surface_vertices_of(cells_around_a_line(image, off), image); };
  const ClaimResult on_line = at(0);
  EXPECT_EQ(on_line.verdict, Verdict::kPass) << on_line.reason;
  EXPECT_EQ(at(0.8 * kBound).verdict, Verdict::kPass);
  EXPECT_EQ(at(1.5 * kBound).num_violations, 1U);
}

TEST(SurfaceVertices, ThoseOfStairsAreNoneOfASmoothInterface) {
  const Image stairs = make_image(kSize, kUnitAffine, two_balls);
  Image round = stairs;
  round.smoothing = smooth(stairs, 1.5, 2);
  const ClaimResult result = surface_vertices_of(cells_on_isosurface(stairs, Space::kRas, 1), round);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_GT(result.num_violations, 350U);  // of 400
  EXPECT_GT(result.details().at("furthest_voxels").get<double>(), 0.1);
}

TEST(SurfaceVertices, TheBoundDecidesOnEitherSide) {
  for (const auto& affine : kAffines)
    for (const Space space : {Space::kRas, Space::kLps, Space::kVoxel}) {
      const Image image = full_box(affine);
      for (const double sign : {-1.0, 1.0}) {
        const auto with = [&](double off) {
          return surface_vertices_of(cell_in_box(image, space, sign * off * kBound), image);
        };
        EXPECT_EQ(with(0.9).verdict, Verdict::kPass);
        const ClaimResult far = with(1.1);
        EXPECT_EQ(far.verdict, Verdict::kFail);
        EXPECT_EQ(far.num_violations, 1U);
        EXPECT_EQ(far.bad_cells, std::vector<GlobalId>{0});
        ASSERT_EQ(far.worst.size(), 1U);
        EXPECT_EQ(far.worst[0].vertices, std::vector<GlobalId>{0});
        EXPECT_EQ(far.worst[0].points.size(), 2U) << "the vertex, and where the label is another";
        EXPECT_EQ(far.worst[0].label, sign > 0 ? 0 : 1);
        EXPECT_NEAR(far.worst[0].value, 1.1 * kBound, 0.1 * kBound);
      }
    }
}

TEST(SurfaceVertices, AVertexFarFromEveryLabelIsInViolation) {
  const Image image = full_box(kUnitAffine);
  const ClaimResult result = surface_vertices_of(cell_in_box(image, Space::kRas, 50), image);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_TRUE(std::isinf(result.worst[0].value));
}

TEST(SurfaceVertices, OtherBoundsAreAskedForByOption) {
  const Image image = full_box(kAnisotropic);
  const Mesh mesh = cell_in_box(image, Space::kRas, 0.01);
  Options options;
  options.vertex_bound_voxels = 0.011;
  EXPECT_EQ(check_surface_vertices(mesh, mapped_adjacency(mesh), image, options).verdict, Verdict::kPass);
  options.vertex_bound_voxels = 0.009;
  EXPECT_EQ(check_surface_vertices(mesh, mapped_adjacency(mesh), image, options).verdict, Verdict::kFail);
}

TEST(SurfaceVertices, LabelsOfFacetsAreWithinReach) {
  const Image image = make_image({16, 6, 6}, kUnitAffine, [](int i, int, int) { return i < 12 ? 1 : 2; });
  Mesh mesh = cell_in_box(image, Space::kRas, 0);
  mesh.vertices = {{4, -0.5, 2}, {5, 2, -0.5}, {5, 5.5, 3}, {5, 3, 5.5}};
  const double least_delta = (std::hypot(8, 0.5) - std::sqrt(3.0)) / 2;
  mesh.cell_labels = {2};
  EXPECT_EQ(surface_vertices_of(mesh, image, 1.01 * least_delta).verdict, Verdict::kPass);
  const ClaimResult result = surface_vertices_of(mesh, image, 0.99 * least_delta);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  ASSERT_EQ(result.num_violations, 1U);
  EXPECT_EQ(result.worst[0].vertices, std::vector<GlobalId>{0});
  EXPECT_EQ(result.worst[0].label, 2);
  EXPECT_EQ(result.details().at("vertices_off_own_labels"), 4);
  for (const LabelValue unknown : {LabelValue{3}, LabelValue{-1}, LabelValue{1} << 40}) {
    mesh.cell_labels = {unknown};
    EXPECT_EQ(surface_vertices_of(mesh, image).num_violations, 4U);
  }
  mesh.cell_labels = {2};
  EXPECT_EQ(check_surface_vertices(mesh, mapped_adjacency(mesh), image, Options{}).verdict, Verdict::kPass)
      << "how far a label may reach follows from delta alone";
  mesh.cell_labels = {1};
  EXPECT_EQ(surface_vertices_of(mesh, image, 0.1).details().at("vertices_off_own_labels"), 0);
}

TEST(SurfaceVertices, ThreadsChangeNothing) {
  const Image image = make_image(kSize, kSheared, two_balls);
  const Mesh mesh = moved(cells_on_isosurface(image, Space::kRas, 1), image, {0.01, 0, 0});
  const ClaimResult one = surface_vertices_of(mesh, image, 100, 1),
                    three = surface_vertices_of(mesh, image, 100, 3);
  EXPECT_EQ(one.reason, three.reason);
  EXPECT_EQ(one.bad_cells, three.bad_cells);
  EXPECT_EQ(one.num_exact, three.num_exact);
}

TEST(SurfaceVertices, AMeshWithoutLabelsIsNotDecided) {
  const Image image = full_box(kUnitAffine);
  Mesh mesh = cell_in_box(image, Space::kRas, 0);
  mesh.cell_labels.clear();
  EXPECT_EQ(surface_vertices_of(mesh, image).verdict, Verdict::kNotRun);
}

// In the middle of four alternating voxels the weights of both labels tie to second order.
TEST(LabelSearch, FindsALabelWhereGradientsVanish) {
  const Image image = make_image({4, 4, 4}, kUnitAffine, [](int i, int j, int) { return 1 + (i + j) % 2; });
  const LabelSearch search(image);
  std::uint64_t num_exact = 0;
  const Point u{1.5, 1.5, 1.2};
  ASSERT_EQ(search.label_at(u, num_exact), 1U);
  EXPECT_EQ(num_exact, 1U) << "a tie";
  const auto found = search.find(
      u, [](std::uint32_t label) { return label == 2; }, kBound, num_exact);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->label, 2U);
  EXPECT_LE(found->distance, kBound);
  // This near the saddle rounded weights tie: only rationals distinguish the labels.
  const Point& at = found->at;
  EXPECT_EQ(LabelFunction(image).exact_label_at({mpq_class(at[0]), mpq_class(at[1]), mpq_class(at[2])}), 2U);
}

TEST(LabelSearch, FindsNothingWhereThereIsNothing) {
  const Image image = full_box(kUnitAffine);
  const LabelSearch search(image);
  std::uint64_t num_exact = 0;
  const auto is_background = [](std::uint32_t label) { return label == 0; };
  EXPECT_FALSE(search.find({5, 5, 5}, is_background, 3, num_exact));
  EXPECT_TRUE(search.find({5, 5, 5}, is_background, 30, num_exact));
}

TEST(LabelReach, BeyondTheGridIsBackground) {
  const Image image = full_box(kAnisotropic);
  const double diagonal = std::hypot(0.5, 0.8, 2.5);
  for (const double past : {0.99, 1.01}) {
    const LabelReach reach(image, 0);  // its reach is a diagonal
    EXPECT_EQ(reach.has(0, {past * diagonal / 0.5 - 1, 5, 4}), past < 1);
    EXPECT_EQ(reach.has(0, {6, 11 - past * diagonal / 0.8, 4}), past < 1);
  }
}

}  // namespace
}  // namespace podm::verify
