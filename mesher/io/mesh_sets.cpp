#include "io/mesh_sets.h"

#include <algorithm>
#include <limits>

namespace podm {

MeshSets::MeshSets(const TetMesh& mesh)
    : names(mesh.labels),
      pairs(mesh.facet_labels),
      cells_of_label(mesh.cells.size(), mesh.labels.size(),
                     [&](std::size_t i) { return mesh.cell_labels[i]; }),
      facets_of_pair(mesh.facets.size(), pairs.size(),
                     [&](std::size_t i) { return pairs.number_of(mesh.facet_labels[i]); }) {
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    if (!cells_of_label[i].empty()) volumes.push_back(static_cast<LabelIndex>(i));
  const bool values_are_tags = std::all_of(volumes.begin(), volumes.end(), [&](LabelIndex label) {
    const std::uint32_t value = mesh.labels[label].value;
    return value > 0 && value <= std::uint32_t{std::numeric_limits<std::int32_t>::max()};
  });
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    volume_tags.push_back(static_cast<std::int32_t>(values_are_tags ? mesh.labels[i].value : i));
}

}  // namespace podm
