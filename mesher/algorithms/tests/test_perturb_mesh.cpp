// R7: better angles, reported correctly, the same from one thread each time, and the result of a run that
// ends in R7. test_refinement.cpp tests that no other rule applies and that the invariants hold.
#include <gtest/gtest.h>

#include <optional>

#include "algorithms/podm.h"
#include "delaunay/tests/cells_by_points.h"
#include "delaunay/tests/validity.h"
#include "image/foreground.h"
#include "refine/dihedral_quality.h"
#include "tests/images.h"

namespace podm::test {
namespace {

class PerturbMesh : public testing::Test {
 protected:
  Refinement refine(std::optional<DihedralBounds> bounds, int num_workers = 1) {
    problem_.dihedral_bounds = bounds;
    return podm(problem_, {.coordination = {.num_workers = num_workers}}, stop_);
  }
  // Counts the cells inside with angles out of bounds, by an independent pass over all cells.
  PerturbationReport::Cells poor(const Mesh& mesh, const DihedralBounds& bounds) const {
    PerturbationReport::Cells cells;
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      if (!mesh.cell(c).is_alive() || isosurface_.label_at(mesh.cell(c).center) == kBackground) continue;
      if (dihedral_quality(mesh, c, bounds) >= 1) continue;
      const auto& v = mesh.cell(c).vertices;
      const bool has_free = std::any_of(
          v.begin(), v.end(), [&](VertexId w) { return mesh.vertex(w).kind == VertexKind::kCircumcenter; });
      ++(has_free ? cells.with_free_vertex : cells.without);
    }
    return cells;
  }
  static std::uint64_t num_unmoved(const PerturbationReport& report) {
    std::uint64_t sum = report.not_reached;
    for (const std::uint64_t cells : report.unmoved) sum += cells;
    return sum;
  }

  const DihedralBounds bounds_{8, 165}, hard_{35, 130};
  LabelImage image_ = ball(40, 18);
  Isosurface isosurface_{image_, 1};
  Problem problem_{.isosurface = isosurface_,
                   .object = foreground_bounds(image_),
                   .delta_mm = 1.2,
                   .sizes = SizeField(std::vector<double>(2, 1.6)),
                   .cell_capacity = 1 << 22};
  StopControl stop_{{}, {}, [](std::uint64_t) {}};
};

TEST_F(PerturbMesh, LeavesFewPoorCellsThatHaveAFreeVertex) {
  const Refinement without = refine(std::nullopt), with = refine(bounds_);
  ASSERT_TRUE(with.perturbation);
  const PerturbationReport::Cells before = poor(*without.mesh, bounds_);
  EXPECT_EQ(with.perturbation->before.with_free_vertex, before.with_free_vertex);
  EXPECT_EQ(with.perturbation->before.without, before.without);
  ASSERT_GT(before.with_free_vertex, 200u);
  EXPECT_LT(with.perturbation->after.with_free_vertex, before.with_free_vertex / 100);
  EXPECT_GT(with.counters.moves, 0u);
  EXPECT_EQ(with.counters.num_insertions(), without.counters.num_insertions()) << "R1 to R5 come first";
}

TEST_F(PerturbMesh, ReportsWhatIsLeftAndWhy) {
  for (const int num_workers : {1, 4}) {
    const Refinement refinement = refine(hard_, num_workers);
    const PerturbationReport::Cells left = poor(*refinement.mesh, hard_);
    ASSERT_TRUE(refinement.perturbation);
    EXPECT_EQ(refinement.perturbation->after.with_free_vertex, left.with_free_vertex);
    EXPECT_EQ(refinement.perturbation->after.without, left.without);
    EXPECT_GT(left.number(), 0u);
    EXPECT_EQ(num_unmoved(*refinement.perturbation), left.number());
    EXPECT_EQ(refinement.perturbation->not_reached, 0u);
  }
}

TEST_F(PerturbMesh, IsTheSameEachTimeOnOneThread) {
  EXPECT_EQ(cells_by_points(*refine(bounds_).mesh), cells_by_points(*refine(bounds_).mesh));
}

TEST_F(PerturbMesh, IsNoPhaseOfARunThatDoesNotAskForIt) {
  const Refinement refinement = refine(std::nullopt);
  EXPECT_FALSE(refinement.phases_s.contains("perturb"));
  EXPECT_FALSE(refinement.perturbation);
  EXPECT_EQ(refinement.counters.moves + refinement.counters.points_tried, 0u);
}

TEST_F(PerturbMesh, MayEndBetweenMoves) {
  problem_.observe_perturbation = [&](double, std::uint64_t) { stop_.end(StopReason::kCancelled); };
  const Refinement refinement = refine(hard_, 2);
  EXPECT_EQ(refinement.stop_reason, StopReason::kCancelled);
  std::string fault;
  EXPECT_TRUE(is_valid(*refinement.mesh, &fault)) << fault;
  ASSERT_TRUE(refinement.perturbation);
  const PerturbationReport::Cells left = poor(*refinement.mesh, hard_);
  EXPECT_GT(refinement.perturbation->not_reached, 0u);
  EXPECT_EQ(num_unmoved(*refinement.perturbation), left.number());
  EXPECT_EQ(refinement.perturbation->after.number(), left.number());
}

}  // namespace
}  // namespace podm::test
