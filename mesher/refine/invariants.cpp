#include "refine/invariants.h"

#include <cmath>

namespace podm {

namespace {

const char* name_of(bool a_on_isosurface, bool b_on_isosurface) {
  if (a_on_isosurface && b_on_isosurface) return "I1 (isosurface to isosurface)";
  return a_on_isosurface || b_on_isosurface ? "I2 (isosurface to other)" : "I3 (other to other)";
}

}  // namespace

bool holds_invariants(const Mesh& mesh, double spacing_mm, double slack, std::string* fault) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    for (const auto& edge : kEdgeVertices) {
      const VertexId v = mesh.cell(c).vertices[static_cast<unsigned>(edge[0])];
      const VertexId w = mesh.cell(c).vertices[static_cast<unsigned>(edge[1])];
      const bool v_iso = mesh.vertex(v).kind == VertexKind::kIsosurface;
      const bool w_iso = mesh.vertex(w).kind == VertexKind::kIsosurface;
      const double required = (v_iso && w_iso ? 1 : k) * spacing_mm * (1 - slack);
      const double found = distance(mesh.point(v), mesh.point(w));
      if (found >= required) continue;
      if (fault != nullptr) {
        *fault = std::string(name_of(v_iso, w_iso)) + ": vertices " + std::to_string(v) + " and " +
                 std::to_string(w) + " are " + std::to_string(found) + " mm apart, " +
                 std::to_string(required) + " required";
      }
      return false;
    }
  }
  return true;
}

}  // namespace podm
