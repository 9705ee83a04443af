// Lines as edges of the mesh: on any number of threads and leaf by leaf, the mesh has them, keeps the bounds
// of all rules, and equals its replay.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "algorithms/podm.h"
#include "algorithms/tests/broken_rule.h"
#include "delaunay/tests/validity.h"
#include "image/foreground.h"
#include "lines/tests/line_images.h"
#include "lines/trace_lines.h"
#include "podm/mesh_image.h"
#include "podm/mesh_io.h"
#include "podm/operation_log.h"
#include "refine/virtual_box.h"
#include "replay/replay.h"
#include "run/extract_lines.h"
#include "run/extract_mesh.h"
#include "run/facets_of_sides.h"
#include "run/measure_quality.h"
#include "smoothing/smooth_interfaces.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr double kLineRadius = 2.5, kLineDelta = 1.2;

struct LineScene {
  const char* name;
  std::function<LabelImage()> make;
  double smoothing_mm = 0;
  bool is_box_flat = false;
  friend std::ostream& operator<<(std::ostream& out, const LineScene& x) { return out << x.name; }
};

LabelImage crystal(unsigned num_grains, bool has_margin) {
  Random random(7 + num_grains);
  return polycrystal(random, {18, 18, 18}, {1, 1, 1}, num_grains, has_margin);
}

LabelImage flat(LabelImage image) {
  image.is_box_flat = true;
  return image;
}

const std::vector<LineScene> kLineScenes{
    {"ten_grains", [] { return crystal(10, false); }},
    {"thirty_grains", [] { return crystal(30, true); }},
    {"sectors",
     [] {
       return sectors({16, 16, 16}, 5, {7.3, 7.6, 7.2}, {0.2, 0.3, 1});
     }},
    {"smoothed_grains", [] { return crystal(10, false); }, 1},
    {"grains_in_a_flat_box", [] { return flat(crystal(10, false)); }, 0, true},
    {"smoothed_grains_in_a_flat_box", [] { return flat(crystal(14, false)); }, 1, true},
};

struct LineMethod {
  Algorithm algorithm;
  int num_workers, num_nodes;
  Executor executor = Executor::kThreads;
  bool is_perturbed = false;
  friend std::ostream& operator<<(std::ostream& out, const LineMethod& m) {
    return out << to_string(m.algorithm) << '_' << m.num_workers << '_' << to_string(m.executor)
               << (m.is_perturbed ? "_perturbed" : "");
  }
};

const std::vector<LineMethod> kLineMethods{{Algorithm::kPodm, 1, 1},
                                           {Algorithm::kPodm, 2, 1},
                                           {Algorithm::kPodm, 16, 1, Executor::kVirtual},
                                           {Algorithm::kPodmHome, 4, 2},
                                           {Algorithm::kPdr, 2, 2},
                                           {Algorithm::kPdrPodm, 4, 2},
                                           {Algorithm::kPodm, 2, 1, Executor::kThreads, true}};

class MeshWithLines : public testing::TestWithParam<std::tuple<LineScene, LineMethod>> {
 protected:
  MeshWithLines() : log_(log_path()), refinement_(refine()) {
    label_cells(*refinement_.mesh, isosurface_, 1);
  }
  ~MeshWithLines() override { std::filesystem::remove(log_path()); }

  static std::string log_path() {
    return (std::filesystem::temp_directory_path() / ("podm_lines_" + std::to_string(getpid()) + ".log"))
        .string();
  }
  Refinement refine() {
    const LineMethod& method = std::get<LineMethod>(GetParam());
    const Problem problem{
        .isosurface = isosurface_,
        .object = foreground_bounds(image_, 1),
        .delta_mm = kLineDelta,
        .sizes = sizes_,
        .cell_capacity = 1 << 22,
        .dihedral_bounds = method.is_perturbed ? std::optional(DihedralBounds(8, 165)) : std::nullopt,
        .lines = &lines_,
        .lines_delta_mm = 1.25 * kLineDelta,
        .box_curves = scene_.is_box_flat ? &box_curves_ : nullptr};
    const Team team{.executor = method.executor,
                    .coordination = {.num_workers = method.num_workers},
                    .num_nodes = method.num_nodes,
                    .initial_workers = method.num_workers,
                    .log = &log_};
    StopControl stop({}, {}, [](std::uint64_t) {});
    return refine_by(method.algorithm, problem, team, {}, stop);
  }
  OperationLog finished_log(const std::string& sha256) {
    const auto& [low, high] = refinement_.mesh->box();
    log_.finish({.box = {low.x, low.y, low.z, high.x, high.y, high.z},
                 .image_sha256 = "",
                 .space = "RAS",
                 .mesh_sha256 = sha256,
                 .is_box_flat = scene_.is_box_flat});
    log_.publish();
    return read_operation_log(log_path());
  }
  TetMesh mesh_of(Mesh& store, MeshingReport& report) {
    MeshLines lines = extract_lines(store, *refinement_.line_edges, image_, report.lines.emplace());
    return extract_mesh(store, isosurface_, Space::kRas, 1, report.guarantees.facet_vertices, {},
                        std::move(lines));
  }

  const LineScene scene_ = std::get<LineScene>(GetParam());
  LabelImage image_ = scene_.make();
  std::shared_ptr<const VoxelWeights> weights_ = weights_of(image_, scene_.smoothing_mm, 1);
  Isosurface isosurface_{image_, 1, weights_};
  SizeField sizes_{std::vector<double>(image_.labels.size(), kLineRadius)};
  LineNetwork network_ = trace_lines(image_, weights_.get(),
                                     {.has_lines = true, .is_box_flat = scene_.is_box_flat, .threads = 1});
  Lines lines_{part_of(network_, [](const LineArc& arc) { return arc.labels.size() >= kLabelsOfLine; }),
               image_, weights_};
  LineNetwork box_curves_ = part_of(network_, [](const LineArc& arc) { return arc.sides != 0; });
  OperationLogWriter log_;
  Refinement refinement_;
};

TEST_P(MeshWithLines, IsDelaunayAndViolatesNoRule) {
  EXPECT_EQ(refinement_.stop_reason, StopReason::kComplete);
  std::string fault;
  EXPECT_TRUE(is_valid(*refinement_.mesh, &fault)) << fault;
  const double spacing = std::min(kLineDelta, kLineRadius / std::sqrt(2 + std::sqrt(3.0)));
  const Parameters parameters{.delta_mm = kLineDelta,
                              .sizes = sizes_,
                              .clamp_box = clamp_box(foreground_bounds(image_, 1), kLineDelta),
                              .spacing_mm = spacing,
                              .lines = refinement_.line_edges.get()};
  EXPECT_EQ(broken_rule(*refinement_.mesh, isosurface_, parameters), "");
}

TEST_P(MeshWithLines, HasTheLinesAsEdgesAndKeepsTheBoundsBesideThem) {
  MeshingReport report;
  const TetMesh mesh = mesh_of(*refinement_.mesh, report);
  measure_quality(mesh, image_, sizes_, 1, report);
  const LinesReport& lines = *report.lines;
  EXPECT_GT(lines.edges, 20u);
  // An edge of these small images is more than 0.1 % of the lines: two may be lost.
  EXPECT_GE(lines.kept_mm + lines.excluded_mm, 0.999 * lines.traced_mm - 2 * lines.delta_mm);
  EXPECT_GE(lines.kept_mm, 0.98 * lines.traced_mm);
  EXPECT_TRUE(report.guarantees.all_met());
  EXPECT_LT(report.quality.max_radius_edge, kRadiusEdgeBound);
  EXPECT_GT(lines.min_facet_angle_near_deg, kFacetAngleBoundNearLines);
  EXPECT_GT(lines.min_facet_angle_away_deg, kFacetAngleBound);
  EXPECT_GT(lines.facets_near, 0u);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& edge : mesh.lines.edges) {
    EXPECT_NE(edge[0], edge[1]);
    EXPECT_TRUE(edges.insert(std::minmax(edge[0], edge[1])).second) << "an edge is there twice";
  }
  for (const auto& labels : mesh.lines.labels_of_line) {
    EXPECT_GE(labels.size(), 3u);
    EXPECT_TRUE(std::ranges::is_sorted(labels));
  }
}

// A vertex at a node may stand for several nodes. All others are where three labels meet.
TEST_P(MeshWithLines, HasItsVerticesOnTheLinesExactly) {
  const LabelFunction label(image_, weights_.get(), scene_.is_box_flat);
  const Mesh& mesh = *refinement_.mesh;
  std::uint64_t inexact = 0;
  for (VertexId v = 0; v < mesh.vertex_bound(); ++v) {
    if (mesh.vertex(v).kind != VertexKind::kLine) continue;
    std::set<LabelIndex> seen = label.labels_around(mesh.point(v), 1e-3);
    if (mesh.vertex(v).sides != 0) seen.insert(kBackground);  // outside
    inexact += seen.size() < 3;
  }
  EXPECT_LE(inexact, refinement_.line_edges->num_inexact + 4 * lines_.network().nodes.size() / 100);
}

// The sides of a vertex are those whose planes it is in. Where three labels meet along an edge and one of
// them is only outside, the edge is in a side.
TEST_P(MeshWithLines, HasItsLinesInTheSidesOfAFlatBox) {
  if (!scene_.is_box_flat) return;
  const BoxPlanes& box = *isosurface_.box();
  MeshingReport report;
  const TetMesh mesh = mesh_of(*refinement_.mesh, report);
  std::size_t num_on_sides = 0;
  for (std::size_t e = 0; e < mesh.lines.edges.size(); ++e) {
    const auto& [a, b] = mesh.lines.edges[e];
    for (const std::uint32_t v : {a, b}) {
      const Point p{mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]};
      EXPECT_EQ(box.clamped(p).sides, mesh.vertex_sides[v]);
    }
    if (mesh.lines.labels_of_line[mesh.lines.line_of_edge[e]].front() != kBackground) continue;
    EXPECT_NE(mesh.vertex_sides[a] & mesh.vertex_sides[b], 0) << "grains fill the image";
    ++num_on_sides;
  }
  EXPECT_GT(num_on_sides, 100u);
  EXPECT_EQ(count_facets_off_sides(*refinement_.mesh, isosurface_, 1), 0u);
}

// R6 removes circumcenter vertices only, and R7 moves only these and samples of the isosurface. A move is
// logged as an insertion that removes the old vertex.
TEST_P(MeshWithLines, HasNoVertexOnALineThatWasRemovedOrMoved) {
  const OperationLog log = finished_log("");
  std::map<std::uint32_t, VertexKind> kinds;
  auto removed = log.all.removed.begin();
  std::size_t num_moved = 0;
  for (const LoggedOperation& operation : log.all.operations) {
    auto kind = static_cast<VertexKind>(operation.kind % (1u << kSidesInLog));
    for (std::uint32_t i = 0; i < operation.num_removed; ++i) {
      const VertexKind old = kinds.extract(*removed++).mapped();
      EXPECT_NE(old, VertexKind::kLine);
      if (operation.kind == kMovedVertex) kind = old;  // only its id changes
      num_moved += old == kind && operation.kind != kMovedVertex;
    }
    kinds[operation.vertex] = kind;
  }
  EXPECT_EQ(num_moved > 0, std::get<LineMethod>(GetParam()).is_perturbed);
}

TEST_P(MeshWithLines, EqualsItsReplay) {
  MeshingReport report;
  TetMesh mesh = mesh_of(*refinement_.mesh, report);
  canonicalize(mesh, 1);
  const OperationLog log = finished_log(mesh_sha256(mesh));
  const std::unique_ptr<Mesh> replayed = replay(log);
  std::uint64_t facets_off_isosurface = 0;
  TetMesh again = extract_mesh(*replayed, isosurface_, Space::kRas, 1, facets_off_isosurface);
  canonicalize(again, 1);
  EXPECT_EQ(mesh_sha256(again), mesh_sha256(mesh));
  EXPECT_EQ(facets_off_isosurface, 0u);
}

std::string name_of_line_test(const testing::TestParamInfo<std::tuple<LineScene, LineMethod>>& test) {
  std::ostringstream text;
  text << std::get<LineScene>(test.param) << '_' << std::get<LineMethod>(test.param);
  std::string name = text.str();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Images, MeshWithLines,
                         testing::Combine(testing::ValuesIn(kLineScenes), testing::ValuesIn(kLineMethods)),
                         name_of_line_test);

}  // namespace
}  // namespace podm::test
