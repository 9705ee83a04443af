// Checks that a finished mesh violates no rule, and that any mesh remembers right what R3 found.
#pragma once

#include <string>
#include <vector>

#include "refine/rules.h"

namespace podm::test {

/// Returns the rule of R1 to R5 that a cell violates, and the cell, or an empty string. Looks for vertices
/// that cover a sample of R1 among all vertices. R1 does not apply where the sample is outside the cell's
/// ball.
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
    bool is_covered = !z || !mesh.is_in_conflict(c, *z);
    for (VertexId v = 0; v < mesh.vertex_bound() && !is_covered; ++v) is_covered = rules.is_covered(*z, v);
    if (!is_covered) return broken("R1");
  }
  return "";
}

/// Returns the facets that pass R3 according to a cell of theirs.
inline std::vector<FacetId> facets_passing_r3(const Mesh& mesh) {
  std::vector<FacetId> facets;
  for (CellId c = 0; c < mesh.cell_bound(); ++c)
    for (unsigned k = 0; mesh.cell(c).is_alive() && k < 4; ++k)
      if ((mesh.facets_passing_r3(c) >> k & 1) != 0) facets.push_back(4 * c + k);
  return facets;
}

/// Returns one of these facets to which R3 applies all the same, from one of its cells or the other, or an
/// empty string. R3 is tested on one facet at a time: no other facet of the cell counts as untested.
inline std::string broken_facet(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters) {
  const Rules rules(mesh, isosurface, parameters);
  for (const FacetId facet : facets_passing_r3(mesh)) {
    const FacetId mirror = mesh.cell(cell_of(facet)).mirrors[static_cast<unsigned>(index_in_cell(facet))];
    if (mirror == kNoFacet) return "facet " + std::to_string(facet) + " is beyond the box";
    for (const FacetId side : {facet, mirror}) {
      mesh.set_mirror(facet, mirror);
      mesh.set_mirror(mirror, facet);
      const CellId c = cell_of(side);
      mesh.add_facets_passing_r3(c, kAllFacets & ~(1u << index_in_cell(side)));
      if (rules.search_untested_facets(rules.examine(c)).center)
        return "R3 asks for facet " + std::to_string(facet) + " from cell " + std::to_string(c);
    }
  }
  return "";
}

}  // namespace podm::test
