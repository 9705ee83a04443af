#include "refine/tests/invariants.h"

#include <algorithm>

#include "podm/bounds.h"

namespace podm {

namespace {

const char* name_of(bool a_on_isosurface, bool b_on_isosurface) {
  if (a_on_isosurface && b_on_isosurface) return "I1 (isosurface to isosurface)";
  return a_on_isosurface || b_on_isosurface ? "I2 (isosurface to other)" : "I3 (other to other)";
}

bool is_on_isosurface(const Mesh& mesh, VertexId v) { return mesh.vertex(v).kind == VertexKind::kIsosurface; }

// Calls visit(VertexId, VertexId, distance) for the edges of every cell, for some edges more than once, until
// it returns false.
template <class Visit>
bool all_of_edges(const Mesh& mesh, const Visit& visit) {
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    for (const auto& edge : kEdgeVertices) {
      const VertexId v = mesh.cell(c).vertices[static_cast<unsigned>(edge[0])];
      const VertexId w = mesh.cell(c).vertices[static_cast<unsigned>(edge[1])];
      if (!visit(v, w, distance(mesh.point(v), mesh.point(w)))) return false;
    }
  }
  return true;
}

}  // namespace

double least_sample_distance(const Mesh& mesh, double spacing_mm) {
  double least = spacing_mm;
  all_of_edges(mesh, [&](VertexId v, VertexId w, double length) {
    if (is_on_isosurface(mesh, v) && is_on_isosurface(mesh, w)) least = std::min(least, length);
    return true;
  });
  return least;
}

bool holds_invariants(const Mesh& mesh, double spacing_mm, double slack, std::string* fault) {
  const double least_iso = kOneNearSample * spacing_mm * (1 - slack);
  const double least_other = kRadiusEdgeBound * least_sample_distance(mesh, spacing_mm) * (1 - slack);
  return all_of_edges(mesh, [&](VertexId v, VertexId w, double found) {
    const bool v_iso = is_on_isosurface(mesh, v), w_iso = is_on_isosurface(mesh, w);
    const double required = v_iso && w_iso ? least_iso : least_other;
    if (found >= required) return true;
    if (fault != nullptr) {
      *fault = std::string(name_of(v_iso, w_iso)) + ": vertices " + std::to_string(v) + " and " +
               std::to_string(w) + " are " + std::to_string(found) + " mm apart, " +
               std::to_string(required) + " required";
    }
    return false;
  });
}

}  // namespace podm
