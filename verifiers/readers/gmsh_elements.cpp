#include "readers/gmsh_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "readers/mesh_parts.h"

namespace podm::verify {
namespace {

constexpr std::int64_t kTriangle = 2, kTetrahedron = 4, kQuadraticTriangle = 9, kQuadraticTetrahedron = 11;

// The number of nodes by type, for types 1 to 38. Gmsh writes higher orders with other numbers; they are
// rare.
constexpr std::array<std::uint8_t, 39> kNodes{0,  2,  3, 4,  4,  8,  6,  5,  3,  6,  9,  10, 27,
                                              18, 14, 1, 8,  20, 15, 13, 9,  10, 12, 15, 15, 21,
                                              4,  5,  6, 20, 35, 56, 22, 28, 0,  0,  16, 25, 36};

std::string name_of_type(std::int64_t type) {
  constexpr std::pair<int, const char*> kNames[] = {{1, "lines"},  {3, "quadrilaterals"}, {5, "hexahedra"},
                                                    {6, "wedges"}, {7, "pyramids"},       {15, "vertices"}};
  for (const auto& [known, name] : kNames)
    if (type == known) return name;
  return fmt::format("elements of Gmsh type {}", type);
}

}  // namespace

std::size_t gmsh_nodes_of(std::int64_t type) {
  return type < 0 || type >= static_cast<std::int64_t>(kNodes.size()) ? 0 : kNodes[type];
}

void GmshElements::make_room(std::int64_t type, std::size_t count) {
  if (type != kTetrahedron && type != kQuadraticTetrahedron) return;
  check_counts(file_, "$Elements", 0, mesh_.cells.size() + count);
  podm::verify::make_room(mesh_.cells, count);
  podm::verify::make_room(physical_, count);
  podm::verify::make_room(entities_, count);
}

void GmshElements::add(std::int64_t type, std::span<const std::uint64_t> nodes, const GmshGroup& group) {
  const auto vertex = [&](std::size_t i) { return tags_.find(nodes[i]); };
  if (type == kTetrahedron || type == kQuadraticTetrahedron) {
    mesh_.cells.push_back({vertex(0), vertex(1), vertex(2), vertex(3)});
    physical_.push_back(group.physical);
    entities_.push_back(group.entity);
    has_physical_ |= group.physical != 0;
    if (type == kQuadraticTetrahedron) ++mesh_.other_cells[kQuadraticTetrahedra];
  } else if (type == kTriangle || type == kQuadraticTriangle) {
    mesh_.facets.push_back({vertex(0), vertex(1), vertex(2)});
    facet_entities_.push_back(group.entity);
    if (type == kQuadraticTriangle) ++mesh_.other_cells[kQuadraticTriangles];
  } else {
    ++mesh_.other_cells[name_of_type(type)];
  }
}

void GmshElements::finish() {
  check_counts(file_, "$Elements", 0, mesh_.cells.size());
  if (mesh_.cells.empty()) return;
  mesh_.cell_labels = std::move(has_physical_ ? physical_ : entities_);
  mesh_.cell_label_array = has_physical_ ? kPhysicalLabels : kEntityLabels;
}

}  // namespace podm::verify
