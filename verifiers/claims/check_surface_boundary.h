// The boundary of each label's cells: its facet sides, and the findings around each vertex and edge of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/adjacency.h"
#include "mesh.h"

namespace podm::verify {

/// Labels by their position among those of the mesh, ascending; 0 is the background: label 0 and outside.
using LabelIndex = std::uint32_t;

struct CellLabelIndices {
  std::vector<LabelValue> labels;  ///< labels[0] = 0; the same on all ranks
  std::vector<LabelIndex> of_cell;

  /// Collective. A mesh without labels counts as a mesh of a single label, 1.
  explicit CellLabelIndices(const Mesh& mesh);
};

/// A facet seen from a cell, with another label on its other side. `vertices` turn counter-clockwise seen
/// from outside the cell, if the cell is positive.
struct Side {
  std::array<VertexId, 3> vertices{};
  LabelIndex label = 0, across = 0;
  CellId cell = 0;
};

/// Returns the sides of all cells of the rank. Those of cells of other ranks are right around the vertices of
/// the rank's own cells.
std::vector<Side> find_sides(const Mesh& mesh, const Adjacency& adjacency,
                             const CellLabelIndices& label_indices, int threads);

/// The sides that have each vertex, ascending.
class SidesOfVertex {
 public:
  SidesOfVertex(const std::vector<Side>& sides, std::size_t num_vertices);
  const std::uint32_t* begin(VertexId v) const { return sides_.data() + begin_[v]; }
  const std::uint32_t* end(VertexId v) const { return sides_.data() + begin_[v + 1]; }

 private:
  std::vector<std::uint32_t> begin_, sides_;
};

/// Counts over the boundary of one label's cells, or of all cells.
struct BoundaryCounts {
  std::uint64_t facets = 0;
  std::uint64_t unbalanced_edges = 0;  ///< not passed as often in one direction as in the other
  // Edges passed four times or more. On triple lines three or more labels meet, the background counted.
  std::uint64_t non_manifold_edges = 0, non_manifold_edges_on_triple_lines = 0;
  // Vertices on no such edge, whose sides make more than one fan.
  std::uint64_t non_manifold_vertices = 0, non_manifold_vertices_on_triple_lines = 0;

  void add(const BoundaryCounts& other);
};

enum class FindingKind { kUnbalancedEdge, kNonManifoldEdge, kNonManifoldVertex };

struct Finding {
  FindingKind kind = FindingKind::kUnbalancedEdge;
  LabelIndex label = 0;  ///< kAllLabels: the boundary of all cells together
  bool is_on_triple_line = false;
  std::vector<VertexId> vertices;  ///< one vertex, or the two of an edge
  std::vector<CellId> cells;       ///< cells whose sides meet there
};

inline constexpr LabelIndex kAllLabels = 0;  ///< the background has no boundary of its own

struct BoundaryFindings {
  std::vector<BoundaryCounts> of_label;  ///< by LabelIndex, of all ranks; kAllLabels: all together
  std::vector<Finding> findings;         ///< every unbalanced edge; of the other kinds the first few
};

/// Collective. The findings are those at the rank's own vertices; an edge belongs to its lesser vertex.
BoundaryFindings inspect_boundary(const Mesh& mesh, const std::vector<Side>& sides,
                                  const SidesOfVertex& sides_of, std::size_t num_labels, int threads);

}  // namespace podm::verify
