// Adds the nodes and elements of a Gmsh file to a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh.h"
#include "readers/item_numbers.h"
#include "readers/mesh_file.h"

namespace podm::verify {

inline constexpr const char* kPhysicalLabels = "gmsh:physical";
inline constexpr const char* kEntityLabels = "gmsh:geometrical";

/// Returns the number of nodes of a Gmsh element type (reference manual, "Node ordering"); 0 for unknown
/// types.
std::size_t gmsh_nodes_of(std::int64_t type);

/// The first physical group (0: none) and the elementary entity of an element.
struct GmshGroup {
  std::int64_t physical = 0, entity = 0;
};

class GmshElements {
 public:
  GmshElements(const MeshFile& file, const ItemNumbers& tags, Mesh& mesh)
      : file_(file), tags_(tags), mesh_(mesh) {}

  void make_room(std::int64_t type, std::size_t count);
  void add(std::int64_t type, std::span<const std::uint64_t> nodes, const GmshGroup& group);
  /// Sets the labels of the cells: physical groups if any cell has one, otherwise entities.
  void finish();

  const std::vector<std::int64_t>& facet_entities() const { return facet_entities_; }

 private:
  const MeshFile& file_;
  const ItemNumbers& tags_;
  Mesh& mesh_;
  bool has_physical_ = false;
  std::vector<LabelValue> physical_, entities_;  // per cell
  std::vector<std::int64_t> facet_entities_;
};

}  // namespace podm::verify
