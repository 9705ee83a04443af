// The refinement on the store: Delaunay, the invariants behind termination, and no cell left that breaks a
// rule.
#include <gtest/gtest.h>

#include "cost_model.h"
#include "images.h"
#include "podm.h"
#include "refine/invariants.h"
#include "refine/virtual_box.h"

namespace podm::test {
namespace {

constexpr double kRadius = 2.5;

// One thread without locks, and more threads than this machine may have cores, by contention manager.
Crew crew(int num_workers, Contention contention, Executor executor = Executor::kThreads) {
  return {executor, {num_workers, contention, {}, 1}};
}
const std::vector<Crew> kCrews{
    crew(1, Contention::kLocal),  crew(2, Contention::kLocal),
    crew(7, Contention::kLocal),  crew(7, Contention::kGlobal),
    crew(7, Contention::kRandom), crew(64, Contention::kLocal, Executor::kVirtual)};

class Refined : public testing::TestWithParam<std::tuple<NamedImage, Crew>> {
 protected:
  Refined()
      : image_(std::get<NamedImage>(GetParam()).make()),
        isosurface_(image_, 1),
        delta_(default_delta_mm(image_, kRadius)),
        sizes_(std::vector<double>(image_.labels.size(), kRadius)) {
    Watch watch({}, {}, [](std::uint64_t) {});
    refinement_ = podm({isosurface_, foreground_bounds(image_), delta_, sizes_, 1 << 22},
                       std::get<Crew>(GetParam()), watch);
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
  const Parameters parameters{delta_, sizes_, clamp_box(foreground_bounds(image_), delta_), spacing()};
  const Rules rules(mesh, isosurface_, parameters);
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    const Examination t = rules.examine(c);
    EXPECT_FALSE(rules.r2_center(t)) << "cell " << c;
    EXPECT_FALSE(rules.r3_surface_center(t)) << "cell " << c;
    EXPECT_FALSE(rules.volume_rule(t)) << "cell " << c;
    const auto z = rules.r1_sample(t);
    if (!z) continue;
    bool is_covered = false;
    for (VertexId v = 0; v < mesh.vertex_bound(); ++v) is_covered = is_covered || rules.is_covered(*z, v);
    EXPECT_TRUE(is_covered) << "cell " << c;
  }
}

TEST_P(Refined, NoFreeVertexStaysNearTheIsosurfaceVertices) {
  const Mesh& mesh = *refinement_.mesh;
  // I2 in its global form: R6 and the rules together keep free vertices k s from every isosurface vertex.
  const double required = std::sqrt(2 + std::sqrt(3.0)) * spacing() * (1 - 1e-6);
  for (VertexId v = 0; v < mesh.vertex_bound(); ++v) {
    if (mesh.vertex(v).kind != VertexKind::kIsosurface) continue;
    for (VertexId w = 0; w < mesh.vertex_bound(); ++w) {
      if (mesh.vertex(w).kind == VertexKind::kCircumcenter) {
        ASSERT_GE(distance(mesh.point(v), mesh.point(w)), required);
      }
    }
  }
}

std::string name_of(const testing::TestParamInfo<std::tuple<NamedImage, Crew>>& test) {
  const auto& [image, crew] = test.param;
  std::string name = image.name;
  name += '_';
  name += std::to_string(crew.coordination.num_workers);
  return name += to_string(crew.coordination.contention) + to_string(crew.executor);
}

INSTANTIATE_TEST_SUITE_P(Images, Refined,
                         testing::Combine(testing::ValuesIn(images()), testing::ValuesIn(kCrews)), name_of);

}  // namespace
}  // namespace podm::test
