// The output mesh: cells with labels, boundary facets with label pairs.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "podm/box_sides.h"
#include "podm/choices.h"
#include "podm/label_image.h"
#include "podm/mesh_lines.h"
#include "podm/topology_report.h"

namespace podm {

/// A number per cell, under a name.
struct CellArray {
  std::string name;
  std::vector<double> values;
};

/// Every cell is positively oriented: with vertices (a,b,c,d), dot(cross(b-a, c-a), d-a) > 0.
struct TetMesh {
  std::vector<std::array<double, 3>> vertices;  ///< coordinates in `space`
  /// One per vertex, the sides of the image's box that it is on, if the box is flat. Otherwise empty.
  std::vector<SideMask> vertex_sides = {};
  std::vector<std::array<std::uint32_t, 4>> cells;   ///< positions in `vertices`
  std::vector<LabelIndex> cell_labels;               ///< one per cell, position in `labels`, never background
  std::vector<std::array<std::uint32_t, 3>> facets;  ///< boundary and interface facets, each once
  /// One per facet: the labels on its two sides, smaller index first; 0 is outside. The facet's normal
  /// (right-hand rule) points out of the cell of the *second* label, towards the first.
  std::vector<std::array<LabelIndex, 2>> facet_labels;
  std::vector<Label> labels;  ///< labels[0] is the background
  Space space = Space::kRas;
  /// True if the cells were optimised: they are then not a Delaunay triangulation.
  bool is_optimized = false;
  /// The width, mm, by which the interfaces of the image were smoothed; 0: not smoothed.
  double smoothing_mm = 0;
  bool is_box_flat = false;  ///< facets at the border of the image lie in the planes of its box
  /// Cells that rounding inverted when a mesh with a flat box was turned into an oblique frame.
  std::uint64_t num_mended_by_turning = 0;
  /// Least and largest dihedral angle, degrees, that all cells keep, if bounds were requested and reached.
  std::optional<std::array<double, 2>> dihedral_bounds_deg = {};
  /// If thin layers were kept, all differences of topology from the image that are left.
  std::optional<std::vector<TopologyReport::Difference>> topology_differences = {};
  MeshLines lines = {};
  std::vector<CellArray> cell_arrays = {};  ///< values of other images (podm/cell_values.h)
};

/// The side of a flat box that a boundary facet lies on, as a set with one bit at most.
inline SideMask side_of_facet(const TetMesh& mesh, std::size_t facet) {
  if (mesh.vertex_sides.empty() || mesh.facet_labels[facet][0] != kBackground) return 0;
  const auto& [a, b, c] = mesh.facets[facet];
  return mesh.vertex_sides[a] & mesh.vertex_sides[b] & mesh.vertex_sides[c];
}

/// The number of that side in mesh files: 1 to 6 in the order of kSideNames, 0 for none.
inline std::uint8_t side_number_of_facet(const TetMesh& mesh, std::size_t facet) {
  const SideMask side = side_of_facet(mesh, facet);
  return side == 0 ? 0 : static_cast<std::uint8_t>(std::countr_zero(side) + 1);
}

}  // namespace podm
