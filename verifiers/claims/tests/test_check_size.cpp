#include <gtest/gtest.h>

#include <cmath>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

ClaimResult size_of(const Mesh& mesh, std::optional<double> radius,
                    std::map<LabelValue, double> radius_of = {}) {
  Options options = two_threads();
  options.radius_mm = radius;
  options.radius_of = std::move(radius_of);
  return check_size(mesh, options);
}

TEST(Size, IsNotRunWithoutABound) {
  const ClaimResult result = size_of(corner(1, 2, 2), std::nullopt);
  EXPECT_EQ(result.verdict, Verdict::kNotRun);
  EXPECT_FALSE(result.reason.empty());
}

TEST(Size, AllowsEqualityAndNotAnUlpMore) {
  const Mesh mesh = corner(1, 2, 2);  // circumradius 3/2
  EXPECT_EQ(size_of(mesh, 1.5).verdict, Verdict::kPass);
  EXPECT_EQ(size_of(mesh, std::nextafter(1.5, 1)).verdict, Verdict::kFail);
  EXPECT_EQ(size_of(corner(1, 2, std::nextafter(2, 3)), 1.5).verdict, Verdict::kFail);
  EXPECT_EQ(size_of(turned_over(mesh), 1.5).verdict, Verdict::kPass);
}

TEST(Size, HoldsEachLabelToItsOwnBound) {
  Mesh mesh = joined(corner(1, 2, 2), corner(2, 4, 4));  // 3/2 and 3
  mesh.cell_labels = {1, 2};
  EXPECT_EQ(size_of(mesh, std::nullopt, {{1, 1.5}, {2, 3}}).verdict, Verdict::kPass);
  EXPECT_EQ(size_of(mesh, std::nullopt, {{1, 3}, {2, 1.5}}).bad_cells, std::vector<CellId>{1});
  EXPECT_EQ(size_of(mesh, 1.5, {{2, 3}}).verdict, Verdict::kPass);
  EXPECT_EQ(size_of(mesh, 1.5, {{1, 3}}).bad_cells, std::vector<CellId>{1});
  const ClaimResult one_label = size_of(mesh, std::nullopt, {{1, 1.5}});
  EXPECT_EQ(one_label.verdict, Verdict::kPass);
  EXPECT_EQ(one_label.num_checked, 1) << "label 2 has no bound";
}

TEST(Size, RejectsFlatCells) {
  EXPECT_EQ(size_of(two_cells({0.5, 0.5, 0}), 1e9).num_violations, 1);
  EXPECT_EQ(size_of(mesh_of({{1, 1, 1}}, {{0, 0, 0, 0}}), 1e9).num_violations, 1);
}

TEST(Size, NamesTheWorstAndOnAPassTheClosest) {
  const Mesh mesh = joined(corner(1, 2, 2), corner(2, 4, 4));
  for (const double bound : {2.0, 10.0}) {
    const ClaimResult result = size_of(mesh, bound);
    ASSERT_FALSE(result.worst.empty());
    EXPECT_EQ(result.worst[0].cells, std::vector<CellId>{1});
    EXPECT_NEAR(result.worst[0].severity, 3 / bound, 1e-12);
  }
}

}  // namespace
}  // namespace podm::verify
