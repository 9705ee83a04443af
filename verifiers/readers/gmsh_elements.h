// Nodes and elements of a Gmsh file on their way into a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

inline constexpr const char* kPhysicalLabels = "gmsh:physical";
inline constexpr const char* kEntityLabels = "gmsh:geometrical";

/// Nodes of a Gmsh element type (reference manual, "Node ordering"); 0 for types that are not known.
std::size_t gmsh_nodes_of(std::int64_t type);

/// Which vertex has which node tag; tags are any numbers.
class GmshNodeTags {
 public:
  void add(std::uint64_t tag) { tags_.emplace_back(tag, static_cast<VertexId>(tags_.size())); }
  /// Must be called once, after the last add(). Throws InputError if a tag is there twice.
  void finish(const MeshFile& file);
  /// kNone for a tag that no node has.
  VertexId find(std::uint64_t tag) const;
  std::size_t size() const { return tags_.size(); }

 private:
  std::vector<std::pair<std::uint64_t, VertexId>> tags_;  // by tag once finished
  std::vector<VertexId> table_;                           // by tag - first tag, if that is about as short
};

/// Where an element belongs: its first physical group (0: none) and its elementary entity.
struct GmshGroup {
  std::int64_t physical = 0, entity = 0;
};

class GmshElements {
 public:
  GmshElements(const MeshFile& file, const GmshNodeTags& tags, Mesh& mesh)
      : file_(file), tags_(tags), mesh_(mesh) {}

  void make_room(std::int64_t type, std::size_t count);
  void add(std::int64_t type, std::span<const std::uint64_t> nodes, const GmshGroup& group);
  /// Labels of the cells: physical groups if any cell has one, else entities.
  void finish();

  const std::vector<std::int64_t>& facet_entities() const { return facet_entities_; }

 private:
  const MeshFile& file_;
  const GmshNodeTags& tags_;
  Mesh& mesh_;
  bool has_physical_ = false;
  std::vector<LabelValue> physical_, entities_;  // of the cells
  std::vector<std::int64_t> facet_entities_;
};

}  // namespace podm::verify
