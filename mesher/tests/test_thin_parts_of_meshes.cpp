// Every component of a label that a mesh loses or cuts was reported as a thin part.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "image/components.h"
#include "image/thin_parts.h"
#include "podm/mesh_image.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr int kSize = 24;
using Vector3 = std::array<double, 3>;

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Returns balls, plates, rods and dumb-bells of 1 to 6 voxels, of several labels, in any direction.
LabelImage shapes(unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto spacing = [&] { return seed % 3 == 0 ? draw(0.5, 2) : 1.0; };
  LabelImage image = make_image({kSize, kSize, kSize}, {spacing(), spacing(), spacing()}, 3,
                                [](int, int, int) { return kBackground; });
  for (int shape = 0; shape < 6; ++shape) {
    Vector3 along{draw(-1, 1), draw(-1, 1), draw(-1, 1)};
    if (random() % 2 == 0) along = {random() % 2 ? 1. : 0., 1, 0};
    const double norm = std::sqrt(dot(along, along));
    const Vector3 center{draw(4, kSize - 5), draw(4, kSize - 5), draw(4, kSize - 5)};
    const double thickness = 1 + static_cast<double>(random() % 6), reach = draw(4, 12);
    const unsigned kind = random() % 4;
    const auto label = static_cast<LabelIndex>(1 + random() % 3);
    for (int k = 0; k < kSize; ++k)
      for (int j = 0; j < kSize; ++j)
        for (int i = 0; i < kSize; ++i) {
          const Vector3 from{i - center[0], j - center[1], k - center[2]};
          const double height = dot(from, along) / norm;
          const double across = std::sqrt(std::max(0.0, dot(from, from) - height * height));
          const bool is_ball = std::sqrt(dot(from, from)) <= thickness;
          const bool is_plate = std::abs(height) <= thickness / 2 && across <= reach;
          const bool is_rod = across <= thickness / 2 + 0.1 && std::abs(height) <= reach;
          const bool is_end = std::hypot(std::abs(height) - reach, across) <= 3.5;
          if (kind == 0 ? is_ball : kind == 1 ? is_plate : is_rod || (kind == 3 && is_end))
            image.voxels[image.index(i, j, k)] = label;
        }
  }
  return image;
}

class Sets {
 public:
  explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::size_t find(std::size_t x) const { return parent_[x] == x ? x : find(parent_[x]); }
  void join(std::size_t x, std::size_t y) { parent_[find(x)] = find(y); }

 private:
  std::vector<std::size_t> parent_;
};

// Returns sets of cells of one label that share facets.
Sets joined_cells(const TetMesh& mesh) {
  Sets sets(mesh.cells.size());
  std::map<std::array<std::uint32_t, 3>, std::size_t> other_side;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (unsigned opposite = 0; opposite < 4; ++opposite) {
      std::array<std::uint32_t, 3> facet{};
      for (unsigned v = 0, n = 0; v < 4; ++v)
        if (v != opposite) facet[n++] = mesh.cells[c][v];
      std::sort(facet.begin(), facet.end());
      const auto [at, is_first] = other_side.try_emplace(facet, c);
      if (!is_first && mesh.cell_labels[at->second] == mesh.cell_labels[c]) sets.join(c, at->second);
    }
  return sets;
}

Vector3 circumcenter(const TetMesh& mesh, std::size_t c) {
  const auto& a = mesh.vertices[mesh.cells[c][0]];
  std::array<Vector3, 3> edges{};
  for (unsigned v = 0; v < 3; ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      edges[v][axis] = mesh.vertices[mesh.cells[c][v + 1]][axis] - a[axis];
  const auto cross = [](const Vector3& x, const Vector3& y) {
    return Vector3{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
  };
  const Vector3 s = cross(edges[1], edges[2]), t = cross(edges[2], edges[0]), u = cross(edges[0], edges[1]);
  Vector3 center{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    center[axis] = a[axis] + (dot(edges[0], edges[0]) * s[axis] + dot(edges[1], edges[1]) * t[axis] +
                              dot(edges[2], edges[2]) * u[axis]) /
                                 (2 * dot(edges[0], s));
  return center;
}

// Returns the component of the nearest of the eight voxels around a point that has the label.
std::optional<Components::Id> component_at(const LabelImage& image, const Components& components,
                                           const Vector3& point_mm, LabelIndex label) {
  std::optional<Components::Id> nearest;
  double least = 1e9;
  Vector3 at{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    at[axis] = (point_mm[axis] - image.voxel_to_ras[4 * axis + 3]) / image.spacing[axis];
  for (int corner = 0; corner < 8; ++corner) {
    const Voxel v{static_cast<int>(std::floor(at[0])) + corner % 2,
                  static_cast<int>(std::floor(at[1])) + corner / 2 % 2,
                  static_cast<int>(std::floor(at[2])) + corner / 4};
    if (std::min({v.i, v.j, v.k}) < 0 || std::max({v.i, v.j, v.k}) >= kSize) continue;
    if (image.voxels[image.index(v.i, v.j, v.k)] != label) continue;
    const double distance = std::hypot(v.i - at[0], v.j - at[1], v.k - at[2]);
    if (distance >= least) continue;
    least = distance;
    nearest = components.of(v);
  }
  return nearest;
}

class ThinPartsOfMeshes : public testing::TestWithParam<unsigned> {};

TEST_P(ThinPartsOfMeshes, ListEachComponentThatIsLostOrCut) {
  const LabelImage image = shapes(GetParam());
  const Components components(image);
  const double voxel_mm = std::cbrt(image.spacing[0] * image.spacing[1] * image.spacing[2]);
  for (const double voxels : {0.5, 1.0, 1.5, 2.0, 3.0, 5.0}) {
    MeshingOptions options;
    options.sizes.delta_mm = voxels * voxel_mm;
    options.sizes.radius_mm = GetParam() % 2 == 0 ? 2 * options.sizes.delta_mm : 0;
    const TetMesh mesh = mesh_image(image, options).mesh;
    std::map<Components::Id, std::set<ThinKind>> said;
    for (const ThinPart& part : find_thin_parts(image, options.sizes.delta_mm, 1))
      said[components.of(part.deepest)].insert(part.kind);
    std::vector<std::set<std::size_t>> pieces(components.size());
    const Sets joined = joined_cells(mesh);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (const auto at = component_at(image, components, circumcenter(mesh, c), mesh.cell_labels[c]))
        pieces[*at].insert(joined.find(c));
    for (Components::Id c = 0; c < components.size(); ++c) {
      if (components[c].label == kBackground) continue;
      EXPECT_TRUE(pieces[c].size() == 1 || said.contains(c)) << "cut: delta " << voxels << " voxels";
      EXPECT_TRUE(!pieces[c].empty() || said[c].contains(ThinKind::kWhole)) << "lost: delta " << voxels;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ThinPartsOfMeshes, testing::Range(0u, 60u));

}  // namespace
}  // namespace podm::test
