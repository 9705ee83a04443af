#include "io/mesh_sets.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace podm {

namespace {

std::size_t number_of_side(SideMask side) {
  return side == 0 ? kNumSides : static_cast<std::size_t>(std::countr_zero(side));
}

// Has a bit for each pair and side of the facets.
std::vector<Patch> find_patches(const TetMesh& mesh, const LabelPairs& pairs) {
  std::vector<Patch> patches;
  std::vector<unsigned> sides_of_pair(pairs.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    sides_of_pair[pairs.number_of(mesh.facet_labels[f])] |= 1u << number_of_side(side_of_facet(mesh, f));
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    if ((sides_of_pair[pair] >> kNumSides & 1) != 0) patches.push_back({pair, 0});
    for (std::size_t side = 0; side < kNumSides; ++side)
      if ((sides_of_pair[pair] >> side & 1) != 0)
        patches.push_back({pair, static_cast<SideMask>(1u << side)});
  }
  return patches;
}

}  // namespace

std::string name_of_side(std::size_t side) { return std::string("box ") + kSideNames[side]; }

FacetPatches::FacetPatches(const TetMesh& mesh)
    : names(mesh.labels), pairs(mesh.facet_labels), patches(find_patches(mesh, pairs)) {}

std::size_t FacetPatches::patch_of(const TetMesh& mesh, std::size_t facet) const {
  const Patch patch{pairs.number_of(mesh.facet_labels[facet]), side_of_facet(mesh, facet)};
  return static_cast<std::size_t>(std::lower_bound(patches.begin(), patches.end(), patch) - patches.begin());
}

std::string FacetPatches::name_of(const Patch& patch) const {
  const std::string of_pair = names.of_pair(pairs[patch.pair]);
  return patch.side == 0 ? of_pair : of_pair + " " + name_of_side(number_of_side(patch.side));
}

MeshSets::MeshSets(const TetMesh& mesh)
    : FacetPatches(mesh),
      cells_of_label(mesh.cells.size(), mesh.labels.size(),
                     [&](std::size_t i) { return mesh.cell_labels[i]; }),
      facets_of_pair(mesh.facets.size(), pairs.size(),
                     [&](std::size_t i) { return pairs.number_of(mesh.facet_labels[i]); }),
      facets_of_patch(mesh.facets.size(), patches.size(), [&](std::size_t i) { return patch_of(mesh, i); }),
      facets_of_side(mesh.facets.size(), kNumSides + 1,
                     [&](std::size_t i) { return number_of_side(side_of_facet(mesh, i)); }),
      edges_of_line(mesh.lines.edges.size(), mesh.lines.labels_of_line.size(),
                    [&](std::size_t i) { return mesh.lines.line_of_edge[i]; }) {
  for (std::size_t side = 0; side < kNumSides; ++side)
    if (!facets_of_side[side].empty()) sides.push_back(side);
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
