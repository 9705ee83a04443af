#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "image/image_topology.h"
#include "label_row.h"
#include "meshed_voxels.h"

namespace podm::verify {
namespace {

ClaimResult surface_of(const Mesh& mesh, const Image* image = nullptr, int threads = 2) {
  Options options;
  options.threads = threads;
  return check_surface(mesh, mapped_adjacency(mesh), image, options);
}

Mesh without_cells(Mesh mesh, const std::vector<std::size_t>& cells) {
  for (auto c = cells.rbegin(); c != cells.rend(); ++c) {
    mesh.cells.erase(mesh.cells.begin() + static_cast<std::ptrdiff_t>(*c));
    mesh.cell_labels.erase(mesh.cell_labels.begin() + static_cast<std::ptrdiff_t>(*c));
  }
  return mesh;
}

TEST(Surface, BoxesBallsAndShellsAreClosedAndCounted) {
  struct Case {
    LabelOf label;
    int components, euler;
  };
  const auto norm = [](int i, int j, int k) {
    return (i - 5) * (i - 5) + (j - 5) * (j - 5) + (k - 5) * (k - 5);
  };
  const std::vector<Case> cases{
      {[](int i, int j, int k) { return i % 4 == 1 && j == 2 && k == 2; }, 3, 3},
      {[norm](int i, int j, int k) { return norm(i, j, k) <= 14; }, 1, 1},
      {[norm](int i, int j, int k) { return norm(i, j, k) <= 24 && norm(i, j, k) > 6; }, 1, 2},
      {[](int i, int j, int k) { return k == 5 && std::max(std::abs(i - 5), std::abs(j - 5)) == 2; }, 1, 0},
  };
  for (const Case& c : cases) {
    const Image image = make_image({11, 11, 11}, kMirrored, c.label);
    const Mesh mesh = kuhn_mesh(image);
    const ClaimResult result = surface_of(mesh, &image);
    EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
    for (const auto& row : {row_of(result, 1), result.details()["all"]}) {
      EXPECT_EQ(row["components"], c.components);
      EXPECT_EQ(row["euler"], c.euler);
      EXPECT_EQ(row["cells"], mesh.cells.size());
      EXPECT_EQ(row["image"]["components_6"], c.components);
      EXPECT_EQ(row["image"]["euler_6"], c.euler);
    }
  }
}

// The union of a label's closed voxels has the Euler number of the mesh that fills it.
TEST(Surface, EulerNumbersAreTheImagesForRandomLabels) {
  unsigned state = 1;
  const Image image = make_image({6, 7, 8}, kUnitAffine, [&](int, int, int) {
    state = state * 1664525U + 1013904223U;
    return (state >> 24) % 4;
  });
  const ClaimResult result = surface_of(kuhn_mesh(image), &image);
  EXPECT_EQ(result.verdict, Verdict::kPass) << result.reason;
  for (const LabelValue label : {1, 2, 3}) {
    const auto& row = row_of(result, label);
    EXPECT_EQ(row["euler"], row["image"]["euler_26"]);
    EXPECT_EQ(row["components"], row["image"]["components_6"]);
    EXPECT_EQ(row["unbalanced_edges"], 0);
  }
  EXPECT_EQ(result.details()["all"]["euler"], result.details()["all"]["image"]["euler_26"]);
  EXPECT_EQ(result.details()["all"]["components"], result.details()["all"]["image"]["components_6"]);
}

TEST(Surface, BoxesThatMeetAtAnEdgeOrACornerAreNotManifoldThere) {
  const auto pair = [](int y, int z) {
    return make_image({4, 4, 4}, kUnitAffine, [=](int i, int j, int k) {
      return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 1 + y && k == 1 + z);
    });
  };
  const ClaimResult edge = surface_of(kuhn_mesh(pair(1, 0))), corner = surface_of(kuhn_mesh(pair(1, 1)));
  EXPECT_EQ(edge.verdict, Verdict::kPass);
  EXPECT_EQ(row_of(edge, 1)["non_manifold_edges"], 1);
  EXPECT_EQ(row_of(edge, 1)["non_manifold_vertices"], 0);
  EXPECT_EQ(row_of(corner, 1)["non_manifold_edges"], 0);
  EXPECT_EQ(row_of(corner, 1)["non_manifold_vertices"], 1);
  EXPECT_GT(corner.num_warnings, 0U);
  ASSERT_FALSE(corner.worst.empty());
  EXPECT_EQ(corner.worst[0].vertices.size(), 1U);
}

TEST(Surface, WhereAThirdLabelMeetsTheyAreCountedApart) {
  const Image image = make_image({4, 4, 4}, kUnitAffine, [](int i, int j, int k) {
    if (k != 1 || i < 1 || i > 2 || j < 1 || j > 2) return 0U;
    return i == j ? 1U : 2U;
  });
  const ClaimResult result = surface_of(kuhn_mesh(image));
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_EQ(row_of(result, 1)["non_manifold_edges"], 1);  // inside, where only 1 and 2 meet
  const Image with_third = make_image({4, 4, 4}, kUnitAffine, [](int i, int j, int k) {
    if (k != 1 || i < 1 || i > 2 || j < 1 || j > 2) return 0U;
    return i == j ? 1U : i == 1 ? 2U : 3U;
  });
  EXPECT_EQ(row_of(surface_of(kuhn_mesh(with_third)), 1)["non_manifold_edges_on_triple_lines"], 1);
}

TEST(Surface, AHoleLeftByADroppedCellIsStillClosed) {
  const Image image = make_image({11, 11, 9}, kUnitAffine, two_boxes);
  EXPECT_EQ(surface_of(without_cells(kuhn_mesh(image), {37})).verdict, Verdict::kPass);
}

TEST(Surface, AnInvertedCellAtTheBoundaryFails) {
  const Image image = make_image({11, 11, 9}, kUnitAffine, two_boxes);
  Mesh mesh = kuhn_mesh(image);
  std::swap(mesh.cells[0][0], mesh.cells[0][1]);
  const ClaimResult result = surface_of(mesh);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_TRUE(std::binary_search(result.bad_cells.begin(), result.bad_cells.end(), 0U));
}

TEST(Surface, AMeshTurnedInsideOutThroughoutIsStillOriented) {
  const Image image = make_image({11, 11, 9}, kUnitAffine, two_boxes);
  Mesh mesh = kuhn_mesh(image);
  list_facets(mesh);
  for (auto& cell : mesh.cells) std::swap(cell[0], cell[1]);
  EXPECT_EQ(surface_of(mesh).verdict, Verdict::kPass);
}

TEST(Surface, AFacetOfThreeCellsFails) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}};
  mesh.cells = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}};
  mesh.cell_labels = {1, 1, 1};
  const ClaimResult result = surface_of(mesh);
  EXPECT_EQ(result.details()["all"]["euler"], 6 - 12 + 10 - 3);
  EXPECT_EQ(result.details()["all"]["components"], 1);
}

TEST(Surface, ListedFacetsAreTheCellsOnes) {
  const Image image = make_image({11, 11, 9}, kMirrored, two_boxes);
  Mesh mesh = kuhn_mesh(image);
  list_facets(mesh);
  EXPECT_EQ(surface_of(mesh).verdict, Verdict::kPass);

  Mesh mislabelled = mesh;
  mislabelled.facet_labels[5] = {3, 8};
  EXPECT_EQ(surface_of(mislabelled).num_violations, 1U);
  Mesh turned = mesh;
  std::swap(turned.facets[5][0], turned.facets[5][1]);
  EXPECT_EQ(surface_of(turned).num_violations, 1U);
  Mesh rotated = mesh;
  std::rotate(rotated.facets[5].begin(), rotated.facets[5].begin() + 1, rotated.facets[5].end());
  EXPECT_EQ(surface_of(rotated).verdict, Verdict::kPass);
  Mesh other_way = rotated;  // labels and normal turned together mean the same
  std::swap(other_way.facets[5][0], other_way.facets[5][1]);
  std::swap(other_way.facet_labels[5][0], other_way.facet_labels[5][1]);
  EXPECT_EQ(surface_of(other_way).verdict, Verdict::kPass);
  Mesh dropped = mesh;
  dropped.facets.pop_back();
  dropped.facet_labels.pop_back();
  EXPECT_EQ(surface_of(dropped).num_violations, 1U);
  Mesh twice = mesh;
  twice.facets.push_back(twice.facets[0]);
  twice.facet_labels.push_back(twice.facet_labels[0]);
  EXPECT_EQ(surface_of(twice).num_violations, 1U);
  Mesh stray = mesh;
  stray.facets[5] = {0, 1, 70000};
  EXPECT_EQ(surface_of(stray).num_violations, 2U);  // the stray one and the missing one
}

TEST(Surface, ListedFacetsWithoutLabelsOnlyWarn) {
  const Image image = make_image({11, 11, 9}, kUnitAffine, two_boxes);
  Mesh mesh = kuhn_mesh(image);
  list_facets(mesh);
  mesh.facet_labels.clear();
  EXPECT_EQ(surface_of(mesh).num_warnings, 0U);
  mesh.facets.pop_back();
  const ClaimResult result = surface_of(mesh);
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_EQ(result.num_warnings, 1U);
}

TEST(Surface, CellsOfLabelZeroAreOutside) {
  const Image image = make_image({11, 11, 9}, kUnitAffine, two_boxes);
  Mesh mesh = kuhn_mesh(image), zeroed = mesh;
  for (LabelValue& label : zeroed.cell_labels) label = label == 7 ? 0 : label;
  const ClaimResult all = surface_of(mesh), part = surface_of(zeroed);
  EXPECT_EQ(row_of(part, 3), row_of(all, 3));
  EXPECT_EQ(part.details()["labels"].size(), 1U);
}

TEST(Surface, WithoutLabelsTheMeshIsOneSolid) {
  const Image image = make_image({11, 11, 9}, kUnitAffine, two_boxes);
  Mesh mesh = kuhn_mesh(image);
  mesh.cell_labels.clear();
  const ClaimResult result = surface_of(mesh);
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_EQ(row_of(result, 1)["euler"], 1);
}

TEST(Surface, AnEmptyMeshIsNotRun) { EXPECT_EQ(surface_of({}).verdict, Verdict::kNotRun); }

TEST(Surface, ThreadsDoNotMatter) {
  const Image image = make_image({13, 11, 9}, kUnitAffine, two_balls);
  const Mesh mesh = kuhn_mesh(image);
  EXPECT_EQ(surface_of(mesh, &image, 1).details(), surface_of(mesh, &image, 7).details());
}

}  // namespace
}  // namespace podm::verify
