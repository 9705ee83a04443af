#include <gtest/gtest.h>

#include <cmath>

#include "claims/tests/small_meshes.h"
#include "errors.h"

namespace podm::verify {
namespace {

ClaimResult size_of(const Mesh& mesh, std::optional<double> radius,
                    std::map<LabelValue, double> radius_of = {}) {
  Options options = two_threads();
  options.radius_mm = radius;
  options.radius_of = std::move(radius_of);
  return check_size(mesh, nullptr, nullptr, options);
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
  Mesh mesh = joined(corner(1, 2, 2), corner(2, 4, 4));  // circumradii 3/2 and 3
  mesh.cell_labels = {1, 2};
  EXPECT_EQ(size_of(mesh, std::nullopt, {{1, 1.5}, {2, 3}}).verdict, Verdict::kPass);
  EXPECT_EQ(size_of(mesh, std::nullopt, {{1, 3}, {2, 1.5}}).bad_cells, std::vector<GlobalId>{1});
  EXPECT_EQ(size_of(mesh, 1.5, {{2, 3}}).verdict, Verdict::kPass);
  EXPECT_EQ(size_of(mesh, 1.5, {{1, 3}}).bad_cells, std::vector<GlobalId>{1});
  const ClaimResult one_label = size_of(mesh, std::nullopt, {{1, 1.5}});
  EXPECT_EQ(one_label.verdict, Verdict::kPass);
  EXPECT_EQ(one_label.num_checked, 1) << "label 2 has no bound";
}

// A corner of edges 2, 2, 2 has the circumcenter (1, 1, 1) and the circumradius sqrt(3).
constexpr double kRadius = 1.7320508075688772;  // rounded: its square is below 3

SizeImage sizes_of(std::array<int, 3> size, std::vector<float> radius_mm) {
  return {.path = "sizes.nii",
          .size = size,
          .voxel_to_ras = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},
          .radius_mm = std::move(radius_mm)};
}

ClaimResult size_by(const SizeImage& sizes, const Mesh& mesh = corner(2, 2, 2), double factor = 1,
                    std::optional<double> radius = std::nullopt) {
  Options options = two_threads();
  options.size_factor = factor;
  options.radius_mm = radius;
  return check_size(mesh, nullptr, &sizes, options);
}

TEST(Size, IsBoundedByThePlaceOfTheCircumcenter) {
  // Voxels are 2 mm apart, the first at the origin: the circumcenter is in the middle of eight voxels.
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, std::vector<float>(8, 1.8F))).verdict, Verdict::kPass);
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, std::vector<float>(8, 1.7F))).verdict, Verdict::kFail);
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, {1, 1, 1, 1, 2.5F, 2.5F, 2.5F, 2.5F})).verdict, Verdict::kPass)
      << "mean 1.75";
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, {1, 1, 1, 1, 2.4F, 2.4F, 2.4F, 2.4F})).verdict, Verdict::kFail)
      << "mean 1.7";
}

TEST(Size, LeavesOutVoxelsWithoutABound) {
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, {0, 0, 0, 0, 0, 0, 0, 1.8F})).verdict, Verdict::kPass);
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, {0, 0, 0, 0, 0, 0, 0, 1.7F})).verdict, Verdict::kFail);
  EXPECT_THROW(size_by(sizes_of({2, 2, 2}, std::vector<float>(8, 0))), InputError);
}

TEST(Size, ReachesHalfAVoxelBeyondTheCenters) {
  const SizeImage one = sizes_of({1, 1, 1}, {0.1F});
  EXPECT_EQ(size_by(one).verdict, Verdict::kFail) << "the circumcentre is a corner of the voxel";
  EXPECT_THROW(size_by(one, shifted(corner(2, 2, 2), {1e-9, 0, 0})), InputError) << "and now beyond";
  EXPECT_EQ(size_by(one, shifted(corner(2, 2, 2), {-2, -2, -2})).verdict, Verdict::kFail);
  EXPECT_THROW(size_by(one, shifted(corner(2, 2, 2), {-2, -2, -2.0000001})), InputError);
  // Only one of two cells has a bound.
  EXPECT_EQ(size_by(one, joined(corner(2, 2, 2), shifted(corner(2, 2, 2), {9, 0, 0}))).bad_cells,
            std::vector<GlobalId>{0});
}

TEST(Size, DecidesTiesExactly) {
  const Mesh mesh = corner(1, 2, 2);  // circumradius 3/2, circumcenter (1/2, 1, 1)
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, std::vector<float>(8, 1.5F)), mesh).verdict, Verdict::kPass);
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, std::vector<float>(8, std::nextafter(1.5F, 1.0F))), mesh).verdict,
            Verdict::kFail);
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, {1, 3, 1, 3, 1, 3, 1, 3}), mesh).verdict, Verdict::kPass)
      << "1 + 2/4";
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, {1, 3, 1, 3, 1, 3, 1, 2.999F}), mesh).verdict, Verdict::kFail);
}

TEST(Size, IsBoundedByTheLeastOfLabelAndPlaceAndByItsFactor) {
  const SizeImage sizes = sizes_of({2, 2, 2}, std::vector<float>(8, 1));
  EXPECT_EQ(size_by(sizes, corner(2, 2, 2), 1.8).verdict, Verdict::kPass);
  EXPECT_EQ(size_by(sizes, corner(2, 2, 2), 1.7).verdict, Verdict::kFail);
  EXPECT_EQ(size_by(sizes, corner(2, 2, 2), 1.8, 1.7).verdict, Verdict::kFail);
  EXPECT_EQ(size_by(sizes, corner(2, 2, 2), kRadius * (1 + 1e-9), 1.8).verdict, Verdict::kPass);
}

TEST(Size, FollowsTheSpaceOfTheMesh) {
  const SizeImage sizes = sizes_of({2, 2, 2}, {1, 9, 9, 9, 9, 9, 9, 9});
  const Mesh at_first = shifted(corner(2, 2, 2), {-1, -1, -1});
  EXPECT_EQ(size_by(sizes, at_first).verdict, Verdict::kFail);
  Mesh lps = at_first;
  for (Point& p : lps.vertices) p[0] = -p[0], p[1] = -p[1];
  lps.space = Space::kLps;
  EXPECT_EQ(size_by(sizes, lps).verdict, Verdict::kFail);
  Mesh voxels = at_first;
  voxels.space = Space::kVoxel;
  EXPECT_EQ(size_by(sizes, voxels).verdict, Verdict::kNotRun);
}

TEST(Size, RejectsFlatCells) {
  EXPECT_EQ(size_by(sizes_of({2, 2, 2}, std::vector<float>(8, 100)), two_cells({0.5, 0.5, 0})).num_violations,
            1);
  EXPECT_EQ(size_of(two_cells({0.5, 0.5, 0}), 1e9).num_violations, 1);
  EXPECT_EQ(size_of(mesh_of({{1, 1, 1}}, {{0, 0, 0, 0}}), 1e9).num_violations, 1);
}

TEST(Size, NamesTheWorstAndOnAPassTheClosest) {
  const Mesh mesh = joined(corner(1, 2, 2), corner(2, 4, 4));
  for (const double bound : {2.0, 10.0}) {
    const ClaimResult result = size_of(mesh, bound);
    ASSERT_FALSE(result.worst.empty());
    EXPECT_EQ(result.worst[0].cells, std::vector<GlobalId>{1});
    EXPECT_NEAR(result.worst[0].severity, 3 / bound, 1e-12);
  }
}

}  // namespace
}  // namespace podm::verify
