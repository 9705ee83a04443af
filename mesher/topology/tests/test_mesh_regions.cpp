// Regions of meshes with random labels against a second count: interior facets, edges and vertices of a
// label, and the rest of space joined at vertices.
#include "topology/mesh_regions.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "delaunay/tests/point_sets.h"
#include "delaunay/tests/triangulator.h"
#include "topology/disjoint_sets.h"

namespace podm {
namespace {

constexpr Affine kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

using Numbers = std::array<std::int64_t, 3>;

Numbers sums_of(const MeshRegions& regions, LabelIndex label) {
  Numbers sums{};
  for (std::uint32_t r = 0; r < regions.size(); ++r)
    if (regions[r].label == label) {
      ++sums[0];
      sums[1] += regions[r].handles;
      sums[2] += regions[r].cavities;
    }
  return sums;
}

// Components, handles and cavities of the open region: a compact set without its boundary has minus the Euler
// characteristic of compact supports. The rest is closed: cells are joined where they touch.
Numbers second_count(const Mesh& mesh, LabelIndex label) {
  std::map<std::set<VertexId>, std::array<int, 2>> faces;  // by vertices: cells of the label, and all
  DisjointSets cells(mesh.cell_bound()), rest(mesh.vertex_bound() + 1);
  const auto outside = static_cast<std::uint32_t>(mesh.vertex_bound());
  std::set<std::uint32_t> roots, roots_of_rest;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    const bool is_in = mesh.label(c) == label;
    const auto& v = mesh.cell(c).vertices;
    for (unsigned subset = 1; subset < 16; ++subset) {
      std::set<VertexId> face;
      for (unsigned i = 0; i < 4; ++i)
        if ((subset >> i & 1) != 0) face.insert(v[i]);
      auto& [of_label, all] = faces[face];
      of_label += is_in;
      ++all;
    }
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = mesh.cell(c).mirrors[k];
      if (mirror == kNoFacet) {
        for (const int i : kFacetVertices[k]) rest.join(outside, v[static_cast<unsigned>(i)]);
        for (unsigned subset = 1; subset < 16; ++subset) {  // beyond the box is the rest
          if ((subset >> k & 1) != 0) continue;
          std::set<VertexId> face;
          for (unsigned i = 0; i < 4; ++i)
            if ((subset >> i & 1) != 0) face.insert(v[i]);
          ++faces[face][1];
        }
      } else if (is_in && mesh.label(cell_of(mirror)) == label) {
        cells.join(c, cell_of(mirror));
      }
    }
    for (unsigned i = 1; !is_in && i < 4; ++i) rest.join(v[0], v[i]);
  }
  std::int64_t euler = 0;
  std::set<VertexId> of_rest;
  for (const auto& [face, count] : faces) {
    const bool is_in = count[0] == count[1];
    if (is_in) euler += face.size() % 2 == 0 ? 1 : -1;
    if (!is_in && face.size() == 1) of_rest.insert(*face.begin());
  }
  for (const VertexId v : of_rest) roots_of_rest.insert(rest.root(v));
  for (CellId c = 0; c < mesh.cell_bound(); ++c)
    if (mesh.cell(c).is_alive() && mesh.label(c) == label) roots.insert(cells.root(c));
  const auto components = static_cast<std::int64_t>(roots.size()),
             cavities = static_cast<std::int64_t>(roots_of_rest.size()) - 1;
  return {components, components + cavities - euler, cavities};
}

TEST(MeshRegions, NumbersAreThoseOfASecondCount) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    test::Triangulator t(test::kBox);
    for (const Point& p : test::random_points(seed, 20 + 10 * static_cast<int>(seed % 12), 8)) t.insert(p);
    std::mt19937 random(seed);
    const unsigned num_labels = 1 + seed % 3, share = 3 + seed % 7;
    for (CellId c = 0; c < t.mesh.cell_bound(); ++c)
      if (t.mesh.cell(c).is_alive())
        t.mesh.label(c) = static_cast<LabelIndex>(random() % 10 < share ? 1 + random() % num_labels : 0);
    const MeshRegions regions(t.mesh, kIdentity);
    for (LabelIndex label = 1; label <= num_labels; ++label)
      EXPECT_EQ(sums_of(regions, label), second_count(t.mesh, label)) << "seed " << seed;
  }
}

// Labels by place make shapes like those of images.
TEST(MeshRegions, AShellHasACavityAndATorusAHandle) {
  test::Triangulator t(test::kBox);
  for (const Point& p : test::random_points(1, 4000, 8)) t.insert(p);
  const auto label_by = [&](const auto& is_in) {
    for (CellId c = 0; c < t.mesh.cell_bound(); ++c)
      if (t.mesh.cell(c).is_alive()) t.mesh.label(c) = is_in(t.mesh.cell(c).center) ? 1 : 0;
    const MeshRegions regions(t.mesh, kIdentity);
    std::uint32_t largest = 0;
    for (std::uint32_t r = 0; r < regions.size(); ++r)
      if (regions[r].num_cells > regions[largest].num_cells) largest = r;
    return std::array{regions[largest].handles, regions[largest].cavities};
  };
  const auto radius = [](const Point& p) { return std::hypot(p.x, p.y, p.z); };
  EXPECT_EQ(label_by([&](const Point& p) { return radius(p) < 6 && radius(p) > 2.5; }),
            (std::array<std::int64_t, 2>{0, 1}));
  EXPECT_EQ(label_by([&](const Point& p) { return std::hypot(std::hypot(p.x, p.y) - 4.5, p.z) < 2; }),
            (std::array<std::int64_t, 2>{1, 0}));
}

}  // namespace
}  // namespace podm
