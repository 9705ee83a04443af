// A mesh as the named sets that solvers use: the cells of each label, the facets of each pair of labels, the
// edges of each line.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "io/grouping.h"
#include "io/label_table.h"
#include "podm/tet_mesh.h"

namespace podm {

/// The facets of a pair of labels on one side of a flat box, or on none.
struct Patch {
  std::size_t pair = 0;
  SideMask side = 0;  ///< with one bit at most

  auto operator<=>(const Patch&) const = default;
};

/// The name of the set of all facets on a side: "box i-".
std::string name_of_side(std::size_t side);

/// The facets by pair of labels and side, for formats in which a facet has one number.
struct FacetPatches {
  explicit FacetPatches(const TetMesh& mesh);

  LabelNames names;
  LabelPairs pairs;
  /// The patches that have facets, sorted. With an open box they are the pairs. Each facet is in one patch.
  std::vector<Patch> patches;
  /// Returns the position of a facet's patch; `mesh` is that of the constructor.
  std::size_t patch_of(const TetMesh& mesh, std::size_t facet) const;
  /// Returns the name of a patch: "kidney|outside", or "kidney|outside box i-".
  std::string name_of(const Patch& patch) const;
};

struct MeshSets : FacetPatches {
  explicit MeshSets(const TetMesh& mesh);

  Grouping cells_of_label, facets_of_pair;
  std::vector<LabelIndex> volumes;  ///< the labels that have cells
  Grouping facets_of_patch;
  std::vector<std::size_t> sides;  ///< the sides that have facets
  Grouping facets_of_side;         ///< by side; the last group is on none
  Grouping edges_of_line;
  std::vector<std::string> line_names;  ///< "liver|kidney|outside", one per line
  /// The tag of each label: its value if the values of all `volumes` are positive 32-bit integers, otherwise
  /// its position.
  std::vector<std::int32_t> volume_tags;
  /// Returns the tag of a side, after those of all pairs.
  std::int32_t side_tag(std::size_t side) const { return surface_tag(pairs.size() + side); }
  /// Returns the tag of a pair; tags count from 1.
  static std::int32_t surface_tag(std::size_t pair) { return static_cast<std::int32_t>(pair) + 1; }
  /// Returns the tag of a line; tags count from 1.
  static std::int32_t line_tag(std::size_t line) { return static_cast<std::int32_t>(line) + 1; }
};

/// Returns the vertices of the edges of a line, in ascending order.
std::vector<std::uint32_t> vertices_of_line(const MeshSets& sets, const MeshLines& lines, std::size_t line);

}  // namespace podm
