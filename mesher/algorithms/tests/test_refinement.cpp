// Refinement on the store: the mesh is Delaunay, the invariants behind termination hold, and no cell is left
// that violates a rule. R3 does not apply to the facets that count as tested.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "algorithms/podm.h"
#include "algorithms/tests/broken_rule.h"
#include "delaunay/tests/validity.h"
#include "image/foreground.h"
#include "image/working_frame.h"
#include "podm/mesh_image.h"
#include "refine/tests/invariants.h"
#include "refine/virtual_box.h"
#include "smoothing/smooth_interfaces.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr double kRadius = 2.5;

// An image, and options that change its isosurface and the sizes of cells.
struct Scene {
  NamedImage image;
  double smoothing_mm = 0;
  bool has_size_grid = false;
  bool has_deltas = false;  // by place
  friend std::ostream& operator<<(std::ostream& out, const Scene& x) { return out << x.image; }
};

std::vector<Scene> plain_scenes() {
  std::vector<Scene> scenes;
  for (const NamedImage& image : images()) scenes.push_back({image});
  return scenes;
}

// Voxels ten times as long as wide, smoothed interfaces, sizes by place, deltas by place, and all of these.
std::vector<Scene> special_scenes() {
  const auto ball_of = [](std::array<int, 3> size, std::array<double, 3> spacing) {
    return make_image(size, spacing, 2, [=](int i, int j, int k) {
      const std::array<int, 3> at{i, j, k};
      std::array<double, 3> mm;
      for (std::size_t a = 0; a < 3; ++a) mm[a] = spacing[a] * (at[a] - (size[a] - 1) / 2.0);
      return std::hypot(mm[0], mm[1], mm[2]) >= 9 ? 0 : mm[0] + mm[1] < 2 ? 1 : 2;
    });
  };
  const auto cubes = [=] { return ball_of({24, 24, 24}, {1, 1, 1}); };
  const auto long_voxels = [=] { return ball_of({42, 42, 6}, {0.5, 0.5, 5}); };
  return {
      {.image = {"long_voxels", long_voxels}},
      {.image = {"smoothed", cubes}, .smoothing_mm = 1.5},
      {.image = {"sizes_by_place", cubes}, .has_size_grid = true},
      {.image = {"deltas_by_place", cubes}, .has_deltas = true},
      {.image = {"all_four", long_voxels}, .smoothing_mm = 1.5, .has_size_grid = true, .has_deltas = true}};
}

// Deltas that are as small as a quarter in the middle of the image.
std::shared_ptr<const DeltaField> small_deltas(const LabelImage& image, double delta_mm) {
  DeltasAtVoxels deltas(image, delta_mm / 4, delta_mm);
  deltas.lower(image.index(image.size[0] / 2, image.size[1] / 2, image.size[2] / 2), 0);
  return deltas.graded();
}

// Sizes that shrink along x, from kRadius at one end of the image to a half of it at the other.
std::shared_ptr<const SizeGrid> shrinking_sizes(const LabelImage& image) {
  std::vector<float> radii;
  for (std::size_t v = 0; v < image.num_voxels(); ++v) {
    const auto n = static_cast<std::size_t>(image.size[0]);
    radii.push_back(
        static_cast<float>(kRadius * (1 - 0.5 * static_cast<double>(v % n) / static_cast<double>(n))));
  }
  const ScalarGrid grid(image.size, inverse(voxels_to_working(image)),
                        std::make_shared<const std::vector<float>>(std::move(radii)));
  return std::make_shared<const SizeGrid>(SizeGrid::Image{grid}, std::vector<NearInterface>(), std::nullopt,
                                          foreground_bounds(image));
}

// An algorithm and its workers.
struct Method {
  Algorithm algorithm;
  int num_workers, num_nodes;
  Contention contention = Contention::kLocal;
  Executor executor = Executor::kThreads;
  bool is_perturbed = false;  // R7 runs after the other rules

  Refinement operator()(const Problem& problem, StopControl& stop) const {
    const Team team{.executor = executor,
                    .coordination = {.num_workers = num_workers, .contention = contention},
                    .num_nodes = num_nodes,
                    .initial_workers = num_workers};
    if (algorithm == Algorithm::kPdr) return pdr(problem, team, {}, stop);
    if (algorithm == Algorithm::kPdrPodm) return pdr_podm(problem, team, {}, stop);
    return podm(problem, team, stop);
  }
};

// One thread without locks, and more threads than this machine may have cores.
const std::vector<Method> kMethods{{Algorithm::kPodm, 1, 1},
                                   {Algorithm::kPodm, 2, 1},
                                   {Algorithm::kPodm, 7, 1},
                                   {Algorithm::kPodm, 7, 1, Contention::kGlobal},
                                   {Algorithm::kPodm, 7, 1, Contention::kRandom},
                                   {Algorithm::kPodm, 64, 1, Contention::kLocal, Executor::kVirtual},
                                   {Algorithm::kPdr, 1, 1},
                                   {Algorithm::kPdr, 4, 4},
                                   {Algorithm::kPdrPodm, 6, 3},
                                   {Algorithm::kPdrPodm, 64, 8, Contention::kLocal, Executor::kVirtual},
                                   {Algorithm::kPodm, 1, 1, Contention::kLocal, Executor::kThreads, true},
                                   {Algorithm::kPodm, 7, 1, Contention::kLocal, Executor::kThreads, true},
                                   {Algorithm::kPodm, 64, 1, Contention::kLocal, Executor::kVirtual, true},
                                   {Algorithm::kPdrPodm, 6, 3, Contention::kLocal, Executor::kThreads, true}};

std::vector<Method> few_methods() {
  std::vector<Method> methods;
  for (const bool is_perturbed : {false, true})
    for (const int num_workers : {1, 2})
      methods.push_back(
          {Algorithm::kPodm, num_workers, 1, Contention::kLocal, Executor::kThreads, is_perturbed});
  return methods;
}

class Refined : public testing::TestWithParam<std::tuple<Scene, Method>> {
 protected:
  Refined() : refinement_(refine({})) {}

  Refinement refine(const Limits& limits) const {
    StopControl stop(limits, {}, [](std::uint64_t) {});
    const Method& method = std::get<Method>(GetParam());
    const Problem problem{
        .isosurface = isosurface_,
        .object = foreground_bounds(image_),
        .delta_mm = delta_,
        .sizes = sizes_,
        .cell_capacity = 1 << 22,
        .dihedral_bounds = method.is_perturbed ? std::optional(DihedralBounds(12, 160)) : std::nullopt,
        .deltas = deltas_};
    return method(problem, stop);
  }
  double spacing() const {
    const double least = deltas_ != nullptr ? deltas_->least_mm() : delta_;
    return std::min(least, std::sqrt(sizes_.smallest_squared_radius() / (2 + std::sqrt(3.0))));
  }
  Parameters parameters() const {
    return {.delta_mm = delta_,
            .sizes = sizes_,
            .clamp_box = clamp_box(foreground_bounds(image_), delta_),
            .spacing_mm = spacing(),
            .deltas = deltas_};
  }

  const Scene scene_ = std::get<Scene>(GetParam());
  LabelImage image_ = scene_.image.make();
  Isosurface isosurface_{image_, 1, weights_of(image_, scene_.smoothing_mm, 1)};
  double delta_ = default_delta_mm(image_, kRadius);
  std::shared_ptr<const DeltaField> deltas_ = scene_.has_deltas ? small_deltas(image_, delta_) : nullptr;
  SizeField sizes_{std::vector<double>(image_.labels.size(), kRadius),
                   scene_.has_size_grid ? shrinking_sizes(image_) : nullptr};
  Refinement refinement_;
};

TEST_P(Refined, CompletesWithAValidTriangulation) {
  EXPECT_EQ(refinement_.stop_reason, StopReason::kComplete);
  std::string fault;
  EXPECT_TRUE(is_valid(*refinement_.mesh, &fault)) << fault;
}

TEST_P(Refined, KeepsTheInvariants) {
  std::string fault;
  EXPECT_TRUE(holds_invariants(*refinement_.mesh, spacing(), 1e-6, &fault)) << fault;
}

TEST_P(Refined, LeavesNoCellThatBreaksARule) {
  EXPECT_EQ(broken_rule(*refinement_.mesh, isosurface_, parameters()), "");
}

TEST_P(Refined, RemembersOnlyFacetsToWhichR3DoesNotApply) {
  EXPECT_FALSE(facets_passing_r3(*refinement_.mesh).empty());
  EXPECT_EQ(broken_facet(*refinement_.mesh, isosurface_, parameters()), "");
}

// A facet counts as tested if one of its cells remembers it.
TEST_P(Refined, TestsR3AgainOnOtherFacetsOnly) {
  Mesh& mesh = *refinement_.mesh;
  const Parameters parameters = this->parameters();
  const Rules rules(mesh, isosurface_, parameters);
  int num_of_neighbors = 0;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    FacetMask tested = mesh.facets_passing_r3(c);
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = mesh.cell(c).mirrors[k];
      if (mirror == kNoFacet || (tested >> k & 1) != 0) continue;
      if ((mesh.facets_passing_r3(cell_of(mirror)) >> index_in_cell(mirror) & 1) == 0) continue;
      tested |= 1u << k;
      ++num_of_neighbors;
    }
    const Examination t = rules.examine(c);
    const FacetMask all = rules.search_all_facets(t).passing;
    ASSERT_EQ(rules.search_untested_facets(t).passing, all & ~tested) << c;
  }
  EXPECT_GT(num_of_neighbors, 0);
}

// Then R3 still applies to other facets.
TEST_P(Refined, RemembersOnlySuchFacetsInTheMiddleOfARun) {
  for (const double share : {0.3, 0.6}) {
    const auto cells = static_cast<double>(refinement_.mesh->num_cells());
    const Refinement part = refine({.max_elements = static_cast<std::uint64_t>(share * cells)});
    EXPECT_EQ(broken_facet(*part.mesh, isosurface_, parameters()), "") << share;
  }
}

TEST_P(Refined, NoFreeVertexStaysNearTheIsosurfaceVertices) {
  const Mesh& mesh = *refinement_.mesh;
  // I2 in its global form: R6 and the other rules together keep free vertices away from every isosurface
  // vertex.
  const double required = kRadiusEdgeBound * least_sample_distance(mesh, spacing()) * (1 - 1e-6);
  for (VertexId v = 0; v < mesh.vertex_bound(); ++v) {
    if (mesh.vertex(v).kind != VertexKind::kIsosurface) continue;
    for (VertexId w = 0; w < mesh.vertex_bound(); ++w) {
      if (mesh.vertex(w).kind == VertexKind::kCircumcenter) {
        ASSERT_GE(distance(mesh.point(v), mesh.point(w)), required);
      }
    }
  }
}

std::string name_of(const testing::TestParamInfo<std::tuple<Scene, Method>>& test) {
  const auto& [scene, method] = test.param;
  std::ostringstream text;
  text << scene << '_' << to_string(method.algorithm) << '_' << method.num_workers << '_'
       << to_string(method.contention) << '_' << to_string(method.executor)
       << (method.is_perturbed ? "_perturbed" : "");
  std::string name = text.str();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Images, Refined,
                         testing::Combine(testing::ValuesIn(plain_scenes()), testing::ValuesIn(kMethods)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Special, Refined,
                         testing::Combine(testing::ValuesIn(special_scenes()),
                                          testing::ValuesIn(few_methods())),
                         name_of);

}  // namespace
}  // namespace podm::test
