// Extraction from the store gives the defined mesh, for any number of threads and any known labels.
#include "run/extract_mesh.h"

#include <gtest/gtest.h>

#include <set>

#include "algorithms/podm.h"
#include "image/foreground.h"
#include "podm/mesh_io.h"
#include "tests/images.h"

namespace podm::test {
namespace {

// Three labels that meet, in an oblique image, in the middle of refinement: no worker has requested the label
// of some cells.
class ExtractMesh : public testing::Test {
 protected:
  ExtractMesh() { refine(); }

  // One thread always makes the same mesh.
  void refine() {
    StopControl stop({.max_elements = 30000}, {}, [](std::uint64_t) {});
    const Problem problem{.isosurface = isosurface_,
                          .object = foreground_bounds(image_),
                          .delta_mm = 0.5,
                          .sizes = SizeField(std::vector<double>(4, 0.6)),
                          .cell_capacity = 1 << 20};
    mesh_ = podm(problem, Team{}, stop).mesh;
    for (CellId c = 0; c < mesh_->cell_bound(); c += 3) {
      if (mesh_->cell(c).is_alive()) mesh_->label(c) = kUnknownLabel;
    }
  }

  static const LabelImage& turned(LabelImage& image) {
    image.voxel_to_ras = affines()[2].affine;
    return image;
  }
  LabelIndex label_of(CellId c) const { return isosurface_.label_at(mesh_->cell(c).center); }
  TetMesh extract(int threads) {
    return extract_mesh(*mesh_, isosurface_, Space::kRas, threads, facets_off_isosurface_);
  }

  LabelImage image_ = make_image({24, 24, 24}, {1, 1, 1}, 3, [](int i, int j, int k) {
    if (std::hypot(i - 11.5, j - 11.5, k - 11.5) >= 10) return 0;
    return k < 9 ? 1 : i < 12 ? 2 : 3;
  });
  Isosurface isosurface_{turned(image_), 1};
  std::unique_ptr<Mesh> mesh_;
  std::uint64_t facets_off_isosurface_ = 0;
};

TEST_F(ExtractMesh, TakesLabelledCellsTheirVerticesAndTheFacetsBetweenLabels) {
  std::size_t cells = 0, facets = 0, facets_off_isosurface = 0;
  std::set<VertexId> vertices;
  for (CellId c = 0; c < mesh_->cell_bound(); ++c) {
    const Cell& cell = mesh_->cell(c);
    if (!cell.is_alive() || label_of(c) == kBackground) continue;
    ++cells;
    vertices.insert(cell.vertices.begin(), cell.vertices.end());
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = cell.mirrors[k];
      if (mirror != kNoFacet && label_of(cell_of(mirror)) >= label_of(c)) continue;
      ++facets;
      facets_off_isosurface += std::any_of(kFacetVertices[k].begin(), kFacetVertices[k].end(), [&](int i) {
        return mesh_->vertex(cell.vertices[static_cast<unsigned>(i)]).kind != VertexKind::kIsosurface;
      });
    }
  }
  std::set<std::array<double, 3>> points;
  for (const VertexId v : vertices) points.insert({mesh_->point(v).x, mesh_->point(v).y, mesh_->point(v).z});
  const TetMesh out = extract(2);
  EXPECT_GT(cells, 20000u);
  EXPECT_EQ(out.cells.size(), cells);
  EXPECT_EQ(out.cell_labels.size(), cells);
  EXPECT_EQ(out.vertices.size(), vertices.size());
  EXPECT_EQ(std::set(out.vertices.begin(), out.vertices.end()), points) << "moved on the way out";
  EXPECT_EQ(out.facets.size(), facets);
  EXPECT_EQ(out.facet_labels.size(), facets);
  EXPECT_GT(facets_off_isosurface, 0u);
  EXPECT_EQ(facets_off_isosurface_, facets_off_isosurface);
}

TEST_F(ExtractMesh, IsTheSameWithAnyNumberOfThreads) {
  std::set<std::string> hashes;
  std::set<std::size_t> counts;
  for (const int threads : {1, 2, 5}) {
    refine();
    hashes.insert(mesh_sha256(extract(threads)));  // in the order of the ids
    counts.insert(facets_off_isosurface_);
  }
  EXPECT_EQ(hashes.size(), 1u);
  EXPECT_EQ(counts.size(), 1u);
}

}  // namespace
}  // namespace podm::test
