// A mesh as the named sets that solvers use: the cells of each label, the facets of each pair of labels.
#pragma once

#include <cstdint>
#include <vector>

#include "io/grouping.h"
#include "io/label_table.h"
#include "podm/tet_mesh.h"

namespace podm {

struct MeshSets {
  explicit MeshSets(const TetMesh& mesh);

  LabelNames names;
  LabelPairs pairs;
  Grouping cells_of_label, facets_of_pair;
  std::vector<LabelIndex> volumes;  ///< the labels that have cells
  /// The tag of each label: its value if the values of all `volumes` are positive 32-bit integers, otherwise
  /// its position.
  std::vector<std::int32_t> volume_tags;
  /// Returns the tag of a pair; tags count from 1.
  static std::int32_t surface_tag(std::size_t pair) { return static_cast<std::int32_t>(pair) + 1; }
};

}  // namespace podm
