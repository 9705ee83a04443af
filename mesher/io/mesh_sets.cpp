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
                     [&](std::size_t i) { return pairs.number_of(mesh.facet_labels[i]); }),
      edges_of_line(mesh.lines.edges.size(), mesh.lines.labels_of_line.size(),
                    [&](std::size_t i) { return mesh.lines.line_of_edge[i]; }) {
  for (const auto& labels : mesh.lines.labels_of_line) line_names.push_back(names.of_line(labels));
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    if (!cells_of_label[i].empty()) volumes.push_back(static_cast<LabelIndex>(i));
  const bool values_are_tags = std::all_of(volumes.begin(), volumes.end(), [&](LabelIndex label) {
    const std::uint32_t value = mesh.labels[label].value;
    return value > 0 && value <= std::uint32_t{std::numeric_limits<std::int32_t>::max()};
  });
  for (std::size_t i = 0; i < mesh.labels.size(); ++i)
    volume_tags.push_back(static_cast<std::int32_t>(values_are_tags ? mesh.labels[i].value : i));
}

std::vector<std::uint32_t> vertices_of_line(const MeshSets& sets, const MeshLines& lines, std::size_t line) {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t edge : sets.edges_of_line[line])
    vertices.insert(vertices.end(), lines.edges[edge].begin(), lines.edges[edge].end());
  std::ranges::sort(vertices);
  const auto repeated = std::ranges::unique(vertices);
  vertices.erase(repeated.begin(), repeated.end());
  return vertices;
}

}  // namespace podm
