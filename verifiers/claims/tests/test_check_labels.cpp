#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "claims/check_labels_circumcenter.h"
#include "claims/claims.h"
#include "image/smoothing.h"
#include "label_row.h"
#include "meshed_voxels.h"

namespace podm::verify {
namespace {

ClaimResult labels_of(const Mesh& mesh, const Image& image, int threads = 2) {
  Options options;
  options.threads = threads;
  return check_labels(mesh, image, options);
}

TEST(Labels, VoxelsCutIntoCellsPassInEveryFrame) {
  for (const auto& affine : kAffines)
    for (const Space space : {Space::kUnstated, Space::kRas, Space::kLps, Space::kVoxel}) {
      const Image image = make_image({13, 11, 9}, affine, two_balls);
      const Mesh mesh = kuhn_mesh(image, space);
      const ClaimResult result = labels_of(mesh, image);
      EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
      EXPECT_EQ(result.num_violations, 0U);
      EXPECT_EQ(result.num_checked, mesh.cells.size());
      EXPECT_EQ(result.details()["within_rounding"], 0);
      for (const LabelValue label : {1, 2}) {
        const auto& row = row_of(result, label);
        EXPECT_EQ(row["dice"], 1);
        EXPECT_NEAR(row["mesh_mm3"].get<double>(), row["image_mm3"].get<double>(), 1e-9);
      }
    }
}

TEST(Labels, TheStatedSpaceCanBeOverridden) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_balls);
  Mesh mesh = kuhn_mesh(image, Space::kLps);
  mesh.space = Space::kRas;
  EXPECT_EQ(labels_of(mesh, image).verdict, Verdict::kFail);
  Options options;
  options.space = Space::kLps;
  EXPECT_EQ(check_labels(mesh, image, options).verdict, Verdict::kPass);
}

TEST(Labels, AnUnstatedSpaceIsSaidToBeAssumed) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_balls);
  const ClaimResult result = labels_of(kuhn_mesh(image, Space::kUnstated), image);
  EXPECT_NE(result.details()["space"].get<std::string>().find("assumed"), std::string::npos);
}

TEST(Labels, AShiftOfMoreThanHalfAVoxelFailsAndOfLessPasses) {
  for (const auto& affine : kAffines) {
    const Image image = make_image({13, 11, 9}, affine, two_boxes);
    const Mesh mesh = kuhn_mesh(image);
    EXPECT_EQ(labels_of(moved(mesh, image, {0.499, 0, 0}), image).verdict, Verdict::kPass);
    const ClaimResult shifted = labels_of(moved(mesh, image, {0.501, 0, 0}), image);
    EXPECT_EQ(shifted.verdict, Verdict::kFail);
    // One layer of voxels leaves each box at its far end.
    EXPECT_EQ(shifted.num_violations, 2U * 5 * 4 * 6);
    EXPECT_EQ(shifted.bad_cells.size(), shifted.num_violations);
    EXPECT_TRUE(std::is_sorted(shifted.bad_cells.begin(), shifted.bad_cells.end()));
  }
}

TEST(Labels, HalfAVoxelIsATieThatIsDecidedExactly) {
  // Label 7 begins where 3 ends. The smaller label wins the tie, so the cells that now lie between are 3's.
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_boxes);
  const Mesh mesh = moved(kuhn_mesh(image), image, {-0.5, 0, 0});
  const ClaimResult result = labels_of(mesh, image);
  EXPECT_GT(result.num_exact, 0U);
  EXPECT_GT(result.details()["within_rounding"], 0);  // 7 would win half an ulp to the right
  EXPECT_EQ(result.verdict, Verdict::kPass);
}

TEST(Labels, ASwapOfTwoLabelsFails) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_balls);
  Mesh mesh = kuhn_mesh(image);
  for (LabelValue& label : mesh.cell_labels) label = 3 - label;
  const ClaimResult result = labels_of(mesh, image);
  EXPECT_EQ(result.num_violations, mesh.cells.size());
  EXPECT_EQ(row_of(result, 1)["dice"], 0);
}

TEST(Labels, OneCellOfAnotherLabelFailsAndIsTheWitness) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_balls);
  Mesh mesh = kuhn_mesh(image);
  mesh.cell_labels[100] = 3 - mesh.cell_labels[100];
  const ClaimResult result = labels_of(mesh, image);
  EXPECT_EQ(result.num_violations, 1U);
  EXPECT_EQ(result.bad_cells, std::vector<GlobalId>{100});
  ASSERT_FALSE(result.worst.empty());
  EXPECT_EQ(result.worst[0].cells, std::vector<GlobalId>{100});
}

TEST(Labels, AMirroredAxisFails) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_balls);
  Mesh mesh = kuhn_mesh(image);
  for (Point& p : mesh.vertices) p[0] = -p[0];
  EXPECT_EQ(labels_of(mesh, image).verdict, Verdict::kFail);
}

TEST(Labels, ALabelTheImageLacksFailsEvenAsNegativeOrHuge) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_balls);
  for (const LabelValue unknown : {LabelValue{9}, LabelValue{-1}, (LabelValue{1} << 32) + 1}) {
    Mesh mesh = kuhn_mesh(image);
    mesh.cell_labels[0] = unknown;
    const ClaimResult result = labels_of(mesh, image);
    EXPECT_EQ(result.num_violations, 2U);  // the cell, and the label
    EXPECT_EQ(result.details()["labels_unknown_to_image"], nlohmann::json::array({unknown}));
  }
}

TEST(Labels, AMissingLabelFailsOnlyIfItIsLarge) {
  for (const int size : {10, 11}) {  // 1000 and 1331 voxels
    const Image image = make_image({30, size, size}, kUnitAffine, [size](int i, int, int) {
      return i < 2 ? 1U : i >= 30 - size ? 2U : 0U;
    });
    Mesh mesh = kuhn_mesh(image);
    std::vector<std::array<VertexId, 4>> cells;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (mesh.cell_labels[c] == 1) cells.push_back(mesh.cells[c]);
    mesh.cells = cells;
    mesh.cell_labels.assign(cells.size(), 1);
    const ClaimResult result = labels_of(mesh, image);
    EXPECT_EQ(result.verdict, size == 10 ? Verdict::kPass : Verdict::kFail);
    EXPECT_EQ(result.details()["labels_absent_in_mesh"].size(), 1U);
  }
}

TEST(Labels, WithoutCellsOrLabelsItIsNotRun) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_balls);
  Mesh mesh = kuhn_mesh(image);
  mesh.cell_labels.clear();
  EXPECT_EQ(labels_of(mesh, image).verdict, Verdict::kNotRun);
  EXPECT_EQ(labels_of({}, image).verdict, Verdict::kNotRun);
}

TEST(Labels, AFlatCellHasNoCircumcentreAndFails) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_balls);
  Mesh mesh = kuhn_mesh(image);
  const auto& first = mesh.vertices[mesh.cells[0][0]];
  mesh.vertices.push_back({first[0] + 1, first[1], first[2]});
  mesh.vertices.push_back({first[0] + 2, first[1], first[2]});
  const auto n = static_cast<VertexId>(mesh.vertices.size());
  mesh.cells.push_back({mesh.cells[0][0], n - 1, n - 2, mesh.cells[0][1]});
  mesh.cell_labels.push_back(1);
  EXPECT_EQ(labels_of(mesh, image).bad_cells, std::vector<GlobalId>{mesh.cells.size() - 1});
}

TEST(Labels, ThreadsDoNotMatter) {
  const Image image = make_image({13, 11, 9}, kSheared, two_balls);
  const Mesh mesh = moved(kuhn_mesh(image), image, {0.8, 0.3, 0});
  const ClaimResult one = labels_of(mesh, image, 1), five = labels_of(mesh, image, 5);
  EXPECT_EQ(one.bad_cells, five.bad_cells);
  ASSERT_EQ(one.worst.size(), five.worst.size());
  for (std::size_t i = 0; i < one.worst.size(); ++i) EXPECT_EQ(one.worst[i].cells, five.worst[i].cells);
  for (const LabelValue label : {1, 2}) EXPECT_EQ(row_of(one, label)["dice"], row_of(five, label)["dice"]);
}

Image smoothed(Image image, double width_mm) {
  image.smoothing = smooth(image, width_mm, 2);
  return image;
}

TEST(Labels, AMeshOfASmoothedImageIsJudgedByThatAlone) {
  for (const auto& affine : {kUnitAffine, kSheared}) {
    const Image stairs = make_image({13, 11, 9}, affine, two_balls), round = smoothed(stairs, 1);
    for (const Image* meshed : {&stairs, &round})
      for (const Image* image : {&stairs, &round}) {
        const ClaimResult result = labels_of(fine_mesh(*meshed), *image);
        EXPECT_EQ(result.verdict, meshed == image ? Verdict::kPass : Verdict::kFail) << result.reason;
        EXPECT_EQ(result.num_violations == 0, meshed == image);
      }
  }
}

TEST(Labels, ASmoothedTieIsDecidedExactly) {
  // The image equals its mirror image, so both sides are equally strong. The tie is midway, and the smaller
  // label wins.
  const Image image =
      smoothed(make_image({12, 7, 7}, kUnitAffine, [](int i, int, int) { return i < 6 ? 3U : 7U; }), 1);
  const ClaimResult result = labels_of(moved(kuhn_mesh(image), image, {-0.5, 0, 0}), image);
  EXPECT_GT(result.num_exact, 0U);
  EXPECT_GT(result.details()["within_rounding"], 0);
  EXPECT_EQ(result.verdict, Verdict::kPass);
}

TEST(Labels, TheExactLabelChangesWhereVoxelWeightsTie) {
  Image image = make_image({4, 4, 4}, kUnitAffine, [](int i, int, int) { return i < 2 ? 3U : 7U; });
  image.smoothing = Smoothing{1, std::vector<std::uint16_t>(image.voxels.size())};
  for (std::size_t v = 0; v < image.voxels.size(); ++v)
    image.smoothing->voxel_weights[v] = image.voxels[v] == 3 ? 20000 : 50001;
  // The label changes 20000/70001 of the way from 1 to 2. The cell is around a point that is 2^-40 off.
  const double unit = 0x1p-40, change = std::floor((1 + 20000.0 / 70001) / unit) * unit;
  for (const double center : {change, change + unit}) {
    Mesh mesh;
    mesh.space = Space::kVoxel;
    for (const auto& [x, y, z] : {Point{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})
      mesh.vertices.push_back({center + 0.125 * x, 1.5 + 0.125 * y, 1.5 + 0.125 * z});
    mesh.cells = {{0, 1, 2, 3}};
    EXPECT_EQ(ExactCircumcenterLabel(mesh, image, Space::kVoxel)(0), center == change ? 3U : 7U);
  }
}

TEST(Labels, VolumeAndDiceOfAShiftedBox) {
  const Image image = make_image({13, 11, 9}, kAnisotropic, two_boxes);
  const ClaimResult result = labels_of(moved(kuhn_mesh(image), image, {0, 2, 0}), image);
  const auto& row = row_of(result, 3);
  EXPECT_NEAR(row["dice"].get<double>(), 3.0 / 5, 1e-12);  // three of five layers in common
  EXPECT_NEAR(row["mesh_mm3"].get<double>(), 4 * 5 * 4 * 0.5 * 0.8 * 2.5, 1e-9);
}

}  // namespace
}  // namespace podm::verify
