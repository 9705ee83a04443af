// is_triangulation() requires that every cell is positive and every mirror is mutual over the same three
// vertices. is_valid() also requires that every sphere passes through its vertices and every interior facet
// is locally Delaunay. A triangulation that is locally Delaunay everywhere is globally Delaunay (Delaunay's
// lemma).
#include "delaunay/tests/validity.h"

#include <algorithm>

#include "geometry/predicates.h"

namespace podm {

namespace {

std::array<VertexId, 3> sorted_facet(const Mesh& mesh, FacetId f) {
  const auto& v = mesh.cell(cell_of(f)).vertices;
  const auto& k = kFacetVertices[static_cast<std::size_t>(index_in_cell(f))];
  std::array<VertexId, 3> facet{v[static_cast<std::size_t>(k[0])], v[static_cast<std::size_t>(k[1])],
                                v[static_cast<std::size_t>(k[2])]};
  std::sort(facet.begin(), facet.end());
  return facet;
}

const char* fault_of_facet(const Mesh& mesh, CellId c, unsigned i) {
  const FacetId mirror = mesh.cell(c).mirrors[i];
  if (mirror == kNoFacet) return nullptr;
  const Cell& other = mesh.cell(cell_of(mirror));
  const auto j = static_cast<std::size_t>(index_in_cell(mirror));
  if (cell_of(mirror) >= mesh.cell_bound() || !other.is_alive()) return "mirror in a dead cell";
  if (other.mirrors[j] != 4 * c + i) return "mirror not mutual";
  if (sorted_facet(mesh, 4 * c + i) != sorted_facet(mesh, mirror)) return "mirror over other vertices";
  return nullptr;
}

const char* fault_of_triangulation(const Mesh& mesh, CellId c) {
  const auto& v = mesh.cell(c).vertices;
  for (const VertexId id : v) {
    if (id >= mesh.vertex_bound() || mesh.vertex(id).kind == VertexKind::kUnused) return "unused vertex";
  }
  if (orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) <= 0) {
    return "not positively oriented";
  }
  if (mesh.is_marked(c)) return "left marked by an operation";
  for (unsigned i = 0; i < 4; ++i) {
    if (const char* fault = fault_of_facet(mesh, c, i)) return fault;
  }
  return nullptr;
}

const char* fault_of_cell(const Mesh& mesh, CellId c) {
  if (const char* fault = fault_of_triangulation(mesh, c)) return fault;
  for (const VertexId id : mesh.cell(c).vertices) {
    const Side side = side_of(mesh.cell(c).center, mesh.cell(c).squared_radius, mesh.point(id));
    if (side != Side::kUndecided) return "circumsphere misses its vertex";
  }
  for (const FacetId mirror : mesh.cell(c).mirrors) {
    if (mirror == kNoFacet) continue;
    const VertexId apex =
        mesh.cell(cell_of(mirror)).vertices[static_cast<std::size_t>(index_in_cell(mirror))];
    if (mesh.is_in_conflict(c, mesh.point(apex))) return "facet not locally Delaunay";
  }
  return nullptr;
}

template <class FaultOfCell>
bool is_sound(const Mesh& mesh, std::string* fault, const FaultOfCell& fault_of_cell) {
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    if (const char* found = fault_of_cell(mesh, c)) {
      if (fault != nullptr) *fault = "cell " + std::to_string(c) + ": " + found;
      return false;
    }
  }
  return true;
}

}  // namespace

bool is_triangulation(const Mesh& mesh, std::string* fault) {
  return is_sound(mesh, fault, fault_of_triangulation);
}
bool is_valid(const Mesh& mesh, std::string* fault) { return is_sound(mesh, fault, fault_of_cell); }

}  // namespace podm
