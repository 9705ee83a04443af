// Facets and cells near the lines that a mesh keeps, where weaker bounds hold.
//
// A point that would come too near a line splits the line instead, and facets beside lines may then have
// smaller angles. A mesh keeps lines if its file promises it, or if --lines-delta states it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "geometry/adjacency.h"
#include "mesh.h"
#include "options.h"

namespace podm::verify {

/// A facet or a cell is near lines if one of its vertices is an end of a line edge (lines_of_mesh.h). If the
/// mesh keeps no lines, nothing is near lines.
class NearLines {
 public:
  /// Collective.
  NearLines(const Mesh& mesh, const Adjacency& adjacency, const Options& options);

  bool are_kept() const { return are_kept_; }
  /// Vertices of the rank's own facets and cells.
  template <class Vertices>
  bool has(const Vertices& vertices) const {
    return are_kept_ &&
           std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) { return is_end_[v] != 0; });
  }

 private:
  bool are_kept_;
  std::vector<std::uint8_t> is_end_;  // of a line edge, by vertex; empty unless lines are kept
};

}  // namespace podm::verify
