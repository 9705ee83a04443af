// Claim boundary_angles.
//   Statement   every planar angle of every boundary facet, between a cell and the outside or between cells
//   of
//               different labels, exceeds the bound (30 degrees unless told otherwise).
//   Rests on    the smallest angle t faces the shortest edge l, and l = 2 R sin t; with l the shortest of the
//   edges
//               l, m, n and A the area, R = l m n / 4 A, so t > bound exactly when 4 A^2 > m^2 n^2
//               sin^2(bound). sin^2 of 30 degrees is 1/4; of another bound it is enclosed between rationals,
//               and a facet in the gap between them, below 1e-15, counts as a violation.
//   Cost        linear in the boundary facets.
//   Not proved  anything about angles inside; facets that only the file lists are not looked at.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

constexpr double kSineGap = 1e-15;

Rational squared_sine(double degrees) {
  if (degrees == 30) return Rational(1) / Rational(4);
  const double sine = std::sin(degrees * (std::numbers::pi / 180));
  return Rational(sine * sine + kSineGap);
}

// The edges squared, the shortest first, by the same decisions for every caller.
int side_of_bound(const TrianglePoints& p, const Rational& sine2, std::uint64_t& num_exact) {
  std::size_t shortest = 0;  // the corner that faces the edge
  for (std::size_t corner = 1; corner < 3; ++corner) {
    const auto longer = [&]<class T>(T) {
      return squared_length<T>(p[(corner + 1) % 3], p[(corner + 2) % 3]) -
             squared_length<T>(p[(shortest + 1) % 3], p[(shortest + 2) % 3]);
    };
    if (sign_of(longer, num_exact) < 0) shortest = corner;
  }
  const auto [low, high] = CGAL::to_interval(sine2);
  const Interval enclosed(low, high);
  const auto excess = [&]<class T>(T) {
    const T others = squared_length<T>(p[shortest], p[(shortest + 1) % 3]) *
                     squared_length<T>(p[shortest], p[(shortest + 2) % 3]);
    if constexpr (std::is_same_v<T, Rational>) {
      return squared_double_area<T>(p) - sine2 * others;
    } else {
      return squared_double_area<T>(p) - enclosed * others;
    }
  };
  return sign_of(excess, num_exact);
}

bool is_boundary(const Mesh& mesh, FacetId f, FacetId mirror) {
  if (mirror == kNone) return true;
  return f < mirror && !mesh.cell_labels.empty() && mesh.cell_labels[f / 4] != mesh.cell_labels[mirror / 4];
}

}  // namespace

ClaimResult check_boundary_angles(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  Tally empty;
  empty.bins.emplace_back("boundary_facet_angle", "degrees", 0, 180, 72);
  const Rational sine2 = squared_sine(options.angle_bound_deg);
  const Tally tally =
      tally_over(adjacency.mirror.size(), options.threads, empty, [&](std::size_t i, Tally& t) {
        const auto f = static_cast<FacetId>(i);
        if (!is_boundary(mesh, f, adjacency.mirror[f])) return;
        std::vector<VertexId> vertices;
        for (const int k : kFacetVertices[f % 4])
          vertices.push_back(mesh.cells[f / 4][static_cast<std::size_t>(k)]);
        const TrianglePoints p{mesh.vertices[vertices[0]], mesh.vertices[vertices[1]],
                               mesh.vertices[vertices[2]]};
        const auto angles = angles_deg(p);
        for (const double angle : angles) t.bins[0].add(angle);
        ++t.num_checked;
        const int side = side_of_bound(p, sine2, t.num_exact);
        if (side > 0) return;
        t.num_ties += side == 0;
        const double least = *std::min_element(angles.begin(), angles.end());
        t.violation(
            {.statement = side == 0 ? "angles exceed the bound (equal to it)" : "angles exceed the bound",
             .cells = {f / 4},
             .vertices = vertices,
             .points = {p.begin(), p.end()},
             .value = least,
             .severity = -least,
             .label = mesh.cell_labels.empty() ? 0 : mesh.cell_labels[f / 4]});
      });
  ClaimResult result = result_of("boundary_angles", tally);
  result.method = "interval arithmetic, then rationals";
  result.details["bound_degrees"] = options.angle_bound_deg;
  result.details["facets_equal_to_bound"] = tally.num_ties;
  result.reason = fmt::format("{} of {} facets with an angle at or under {} degrees", result.num_violations,
                              result.num_checked, options.angle_bound_deg);
  if (tally.num_checked > 0) result.reason += fmt::format("; smallest {:.6g}", result.histograms[0].minimum);
  return result;
}

}  // namespace podm::verify
