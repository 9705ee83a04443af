// Refinement on the store: the mesh is Delaunay, the invariants behind termination hold, and no cell is left
// that violates a rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "algorithms/podm.h"
#include "algorithms/tests/broken_rule.h"
#include "delaunay/tests/validity.h"
#include "image/foreground.h"
#include "podm/mesh_image.h"
#include "refine/tests/invariants.h"
#include "refine/virtual_box.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr double kRadius = 2.5;

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

class Refined : public testing::TestWithParam<std::tuple<NamedImage, Method>> {
 protected:
  Refined()
      : image_(std::get<NamedImage>(GetParam()).make()),
        isosurface_(image_, 1),
        delta_(default_delta_mm(image_, kRadius)),
        sizes_(std::vector<double>(image_.labels.size(), kRadius)) {
    StopControl stop({}, {}, [](std::uint64_t) {});
    const Method& method = std::get<Method>(GetParam());
    const Problem problem{
        .isosurface = isosurface_,
        .object = foreground_bounds(image_),
        .delta_mm = delta_,
        .sizes = sizes_,
        .cell_capacity = 1 << 22,
        .dihedral_bounds = method.is_perturbed ? std::optional(DihedralBounds(12, 160)) : std::nullopt};
    refinement_ = method(problem, stop);
  }
  double spacing() const { return std::min(delta_, kRadius / std::sqrt(2 + std::sqrt(3.0))); }

  LabelImage image_;
  Isosurface isosurface_;
  double delta_;
  SizeField sizes_;
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
  Mesh& mesh = *refinement_.mesh;
  const Parameters parameters{.delta_mm = delta_,
                              .sizes = sizes_,
                              .clamp_box = clamp_box(foreground_bounds(image_), delta_),
                              .spacing_mm = spacing()};
  EXPECT_EQ(broken_rule(mesh, isosurface_, parameters), "");
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

std::string name_of(const testing::TestParamInfo<std::tuple<NamedImage, Method>>& test) {
  const auto& [image, method] = test.param;
  std::ostringstream text;
  text << image.name << '_' << to_string(method.algorithm) << '_' << method.num_workers << '_'
       << to_string(method.contention) << '_' << to_string(method.executor)
       << (method.is_perturbed ? "_perturbed" : "");
  std::string name = text.str();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Images, Refined,
                         testing::Combine(testing::ValuesIn(images()), testing::ValuesIn(kMethods)), name_of);

}  // namespace
}  // namespace podm::test
