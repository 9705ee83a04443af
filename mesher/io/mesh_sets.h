// A mesh as the named sets that solvers use: the cells of each label, the facets of each pair of labels, the
// edges of each line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/grouping.h"
#include "io/label_table.h"
#include "podm/tet_mesh.h"

namespace podm {

struct MeshSets {
  explicit MeshSets(const TetMesh& mesh);

  LabelNames names;
  LabelPairs pairs;
  Grouping cells_of_label, facets_of_pair, edges_of_line;
  std::vector<std::string> line_names;  ///< "liver|kidney|outside", one per line
  std::vector<LabelIndex> volumes;      ///< the labels that have cells
  /// The tag of each label: its value if the values of all `volumes` are positive 32-bit integers, otherwise
  /// its position.
  std::vector<std::int32_t> volume_tags;
  /// Returns the tag of a pair; tags count from 1.
  static std::int32_t surface_tag(std::size_t pair) { return static_cast<std::int32_t>(pair) + 1; }
  /// Returns the tag of a line; tags count from 1.
  static std::int32_t line_tag(std::size_t line) { return static_cast<std::int32_t>(line) + 1; }
};

/// Returns the vertices of the edges of a line, in ascending order.
std::vector<std::uint32_t> vertices_of_line(const MeshSets& sets, const MeshLines& lines, std::size_t line);

}  // namespace podm
