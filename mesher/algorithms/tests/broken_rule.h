// Checks that a finished mesh violates no rule.
#pragma once

#include <string>

#include "refine/rules.h"

namespace podm::test {

/// Returns the rule of R1 to R5 that a cell violates, and the cell, or an empty string. Looks for vertices
/// that cover a sample of R1 among all vertices.
inline std::string broken_rule(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters) {
  const Rules rules(mesh, isosurface, parameters);
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    const auto broken = [&](const char* rule) {
      return std::string(rule) + " asks for cell " + std::to_string(c);
    };
    const Examination t = rules.examine(c);
    if (rules.r2_center(t)) return broken("R2");
    if (rules.r3_surface_center(t)) return broken("R3");
    if (const auto rule = rules.volume_rule(t)) return broken(*rule == Rule::kR4 ? "R4" : "R5");
    const auto z = rules.r1_sample(t);
    bool is_covered = !z;
    for (VertexId v = 0; v < mesh.vertex_bound() && !is_covered; ++v) is_covered = rules.is_covered(*z, v);
    if (!is_covered) return broken("R1");
  }
  return "";
}

}  // namespace podm::test
