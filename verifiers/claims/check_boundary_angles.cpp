// Claim boundary_angles.
//   Statement   Every planar angle of every boundary facet, between a cell and the outside or between cells
//               of different labels, exceeds the bound (by default 30 degrees).
//   Rests on    A facet's smallest angle t is between its two longest edges m and n and is at most 60
//               degrees. With A the area, 2 A = m n sin t. So t > bound exactly if
//               4 A^2 > max(m^2 n^2) sin^2(bound). The bound is the decimal number as typed, or 90 degrees if
//               it is more. sin^2 is exact or above the true value by less than 1e-70 (squared_sine); a facet
//               in that gap would count as a violation. Interval arithmetic decides the clear facets,
//               rationals the rest.
//   Cost        Linear in the boundary facets.
//   Not proved  Anything about angles inside a label. Facets that only the file lists are not checked.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// Returns the sign of the facet's smallest angle minus the bound.
int side_of_bound(const TrianglePoints& p, const Constant& sine2, std::uint64_t& num_exact) {
  return sign_of(
      [&]<class T>(T) {
        const T a = squared_length<T>(p[1], p[2]), b = squared_length<T>(p[2], p[0]),
                c = squared_length<T>(p[0], p[1]);
        return squared_double_area<T>(p) - sine2.in<T>() * larger<T>(larger<T>(a * b, b * c), c * a);
      },
      num_exact);
}

bool is_boundary(const Mesh& mesh, FacetId f, FacetId mirror) {
  if (mirror == kNone) return true;
  return f < mirror && !mesh.cell_labels.empty() && mesh.cell_labels[f / 4] != mesh.cell_labels[mirror / 4];
}

}  // namespace

ClaimResult check_boundary_angles(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  Tally empty;
  empty.bins.emplace_back("boundary_facet_angle", "degrees", 0, 180, 72);
  const Constant sine2(squared_sine(decimal_as_typed(std::min(options.angle_bound_deg, 90.0))));
  const Tally tally =
      over_ranks(mesh, tally_over(own_facets(mesh), options.threads, empty, [&](std::size_t i, Tally& t) {
                   const auto f = static_cast<FacetId>(i);
                   if (!is_boundary(mesh, f, adjacency.mirror[f])) return;
                   const auto vertices = vertices_of(mesh, f);
                   const TrianglePoints p = points_of(mesh, vertices);
                   const auto angles = angles_deg(p);
                   for (const double angle : angles) t.bins[0].add(angle);
                   ++t.num_checked;
                   const int side = side_of_bound(p, sine2, t.num_exact);
                   t.num_ties += side == 0;
                   const double least = *std::min_element(angles.begin(), angles.end());
                   const auto witness = [&](const char* statement) {
                     return Witness{.statement = statement,
                                    .cells = {global_cell(mesh, f / 4)},
                                    .vertices = global_vertices(mesh, vertices),
                                    .points = {p.begin(), p.end()},
                                    .value = least,
                                    .severity = -least,
                                    .label = mesh.cell_labels.empty() ? 0 : mesh.cell_labels[f / 4]};
                   };
                   if (side <= 0) {
                     t.violation(witness(side == 0 ? "angles exceed the bound (equal to it)"
                                                   : "angles exceed the bound"));
                   } else if (t.closest.wants(-least)) {
                     t.closest.add(witness("angles exceed the bound"));
                   }
                 }));
  ClaimResult result = result_of("boundary_angles", tally);
  result.method = "interval arithmetic, then rationals";
  result.details()["bound_degrees"] = options.angle_bound_deg;
  result.details()["facets_equal_to_bound"] = tally.num_ties;
  result.reason = fmt::format("{} of {} facets with an angle at or under {} degrees", result.num_violations,
                              result.num_checked, options.angle_bound_deg);
  if (tally.num_checked > 0) result.reason += fmt::format("; smallest {:.6g}", result.histograms[0].minimum);
  return result;
}

}  // namespace podm::verify
