// A mesh as the sets that solvers know by name: the cells of each label, the facets of each pair of labels.
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
  std::vector<LabelIndex> volumes;        ///< the labels that have cells
  std::vector<std::int32_t> volume_tags;  ///< by label: its value; its position, for all, unless all of
                                          ///< `volumes` have values that are positive 32-bit integers
  /// Pairs are numbered from 1.
  static std::int32_t surface_tag(std::size_t pair) { return static_cast<std::int32_t>(pair) + 1; }
};

}  // namespace podm
