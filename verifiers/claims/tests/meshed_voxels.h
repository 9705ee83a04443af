// Images and meshes for the tests of claims that compare a mesh with an image.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "geometry/adjacency.h"
#include "image/image.h"
#include "image/image_frame.h"
#include "image/label_function.h"
#include "mesh.h"

namespace podm::verify {

using LabelOf = std::function<std::uint32_t(int, int, int)>;

inline Image make_image(const std::array<int, 3>& size, const std::array<double, 12>& voxel_to_ras,
                        const LabelOf& label) {
  Image image;
  image.size = size;
  image.voxel_to_ras = voxel_to_ras;
  for (std::size_t axis = 0; axis < 3; ++axis)
    image.spacing[axis] = std::hypot(voxel_to_ras[axis], voxel_to_ras[4 + axis], voxel_to_ras[8 + axis]);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) image.voxels.push_back(label(i, j, k));
  return image;
}

inline const std::array<double, 12> kUnitAffine{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
inline const std::array<double, 12> kAnisotropic{0.5, 0, 0, -20, 0, 0.8, 0, 30, 0, 0, 2.5, 7};
inline const std::array<double, 12> kMirrored{-0.5, 0, 0, 20, 0, 0.8, 0, 30, 0, 0, 2.5, 7};
inline const std::array<double, 12> kSheared{0.5, 0.3, 0, -20, 0, 0.8, 0, 30, 0, 0.4, 2.5, 7};
inline const std::array<std::array<double, 12>, 4> kAffines{kUnitAffine, kAnisotropic, kMirrored, kSheared};

/// Returns the label in a solid ball of label 1 with a ball of label 2 beside it, in 13 x 11 x 9 voxels.
inline std::uint32_t two_balls(int i, int j, int k) {
  const auto within = [&](double x, double y, double z, double r) {
    return (i - x) * (i - x) + (j - y) * (j - y) + (k - z) * (k - z) <= r * r;
  };
  return within(4, 5, 4, 3.2) ? 1 : within(8.5, 5, 4, 2.4) ? 2 : 0;
}

/// Returns the label in two boxes that share a face, labels 3 and 7.
inline std::uint32_t two_boxes(int i, int j, int k) {
  if (j < 2 || j > 6 || k < 2 || k > 5 || i < 2 || i > 9) return 0;
  return i < 6 ? 3 : 7;
}

/// Returns a mesh in which each voxel that is not background is six tetrahedra around its diagonal (Kuhn),
/// alike in all voxels, so that they fit. The circumcenters of all six are at the voxel's center.
inline Mesh kuhn_mesh(const Image& image, Space space = Space::kRas) {
  constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  Mesh mesh;
  mesh.space = space;
  std::map<std::array<int, 3>, VertexId> ids;
  const ImageFrame frame(image, space);
  const auto id_of = [&](const std::array<int, 3>& corner) {
    const auto [place, is_new] = ids.try_emplace(corner, static_cast<VertexId>(mesh.vertices.size()));
    if (is_new)
      mesh.vertices.push_back(frame.voxels_to_mesh({corner[0] - 0.5, corner[1] - 0.5, corner[2] - 0.5}));
    return place->second;
  };
  std::size_t index = 0;
  for (int k = 0; k < image.size[2]; ++k)
    for (int j = 0; j < image.size[1]; ++j)
      for (int i = 0; i < image.size[0]; ++i, ++index) {
        if (image.voxels[index] == 0) continue;
        for (const auto& order : kOrders) {
          std::array<int, 3> corner{i, j, k};
          std::array<VertexId, 4> cell{id_of(corner)};
          for (std::size_t step = 0; step < 3; ++step) {
            ++corner[order[step]];
            cell[step + 1] = id_of(corner);
          }
          mesh.cells.push_back(cell);
          mesh.cell_labels.push_back(image.voxels[index]);
        }
      }
  for (auto& cell : mesh.cells) {
    std::array<Point, 3> e;
    for (std::size_t v = 0; v < 3; ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        e[v][axis] = mesh.vertices[cell[v + 1]][axis] - mesh.vertices[cell[0]][axis];
    const double det = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                       e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                       e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    if (det < 0) std::swap(cell[2], cell[3]);
  }
  return mesh;
}

/// Returns a mesh of voxels a third as long that has the image's label function at all circumcenters.
inline Mesh fine_mesh(const Image& image) {
  const LabelFunction function(image);
  const auto coarse = [](int i) { return (i - 1) / 3.0; };
  std::array<double, 12> affine = image.voxel_to_ras;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) affine[4 * row + axis] /= 3;
    for (std::size_t axis = 0; axis < 3; ++axis) affine[4 * row + 3] -= affine[4 * row + axis];
  }
  return kuhn_mesh(
      make_image({3 * image.size[0], 3 * image.size[1], 3 * image.size[2]}, affine, [&](int i, int j, int k) {
        return function.label_at({coarse(i), coarse(j), coarse(k)});
      }));
}

/// Moves all vertices by a vector in voxels.
inline Mesh moved(Mesh mesh, const Image& image, const Point& by) {
  const ImageFrame frame(image, mesh.space);
  for (Point& p : mesh.vertices) {
    const Point u = frame.to_voxels(p);
    p = frame.voxels_to_mesh({u[0] + by[0], u[1] + by[1], u[2] + by[2]});
  }
  return mesh;
}

/// Finds the adjacency by a map of facets, independently of find_adjacency().
inline Adjacency mapped_adjacency(const Mesh& mesh) {
  std::map<std::array<VertexId, 3>, std::vector<FacetId>> cells_of;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<VertexId, 3> key{};
      for (std::size_t v = 0; v < 3; ++v)
        key[v] = mesh.cells[c][static_cast<std::size_t>(kFacetVertices[i][v])];
      std::sort(key.begin(), key.end());
      cells_of[key].push_back(static_cast<FacetId>(4 * c + i));
    }
  Adjacency adjacency;
  adjacency.mirror.assign(4 * mesh.cells.size(), kNone);
  for (const auto& [key, facets] : cells_of) {
    if (facets.size() > 2) adjacency.crowded.push_back(facets);
    if (facets.size() != 2) continue;
    adjacency.mirror[facets[0]] = facets[1];
    adjacency.mirror[facets[1]] = facets[0];
  }
  return adjacency;
}

/// Lists the facets between different labels as podm's files do: smaller label first, the normal from the
/// second label's cell to the first.
inline void list_facets(Mesh& mesh) {
  const Adjacency adjacency = mapped_adjacency(mesh);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) {
      const FacetId mirror = adjacency.mirror[4 * c + i];
      const LabelValue across = mirror == kNone ? 0 : mesh.cell_labels[mirror / 4];
      if (across >= mesh.cell_labels[c]) continue;
      std::array<VertexId, 3> facet{};
      for (std::size_t v = 0; v < 3; ++v)
        facet[v] = mesh.cells[c][static_cast<std::size_t>(kFacetVertices[i][2 - v])];
      mesh.facets.push_back(facet);
      mesh.facet_labels.push_back({across, mesh.cell_labels[c]});
    }
}

}  // namespace podm::verify
