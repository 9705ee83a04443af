// Claim radius_edge.
//   Statement   every cell has circumradius / shortest edge < bound (1.93 unless told otherwise).
//   Rests on    nothing but the coordinates. With the bound the decimal number p/q as typed, the claim for a
//   cell is
//               q^2 R^2 < p^2 l^2, whose two sides are rational in the coordinates: interval arithmetic
//               decides the clear cells, rationals the rest. A flat cell has no circumsphere and counts as a
//               violation.
//   Cost        linear, about 0.3 us a cell.
//   Not proved  anything about dihedral angles: slivers satisfy the bound. Their histogram is reported.
#include <fmt/format.h>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// R^2 - bound^2 l^2 has this sign, times a positive number; flat cells are above any bound.
int side_of_bound(const CellPoints& p, const Rational& bound, std::uint64_t& num_exact) {
  const auto edge = shortest_edge(p, num_exact);
  const Point &a = p[static_cast<std::size_t>(edge[0])], &b = p[static_cast<std::size_t>(edge[1])];
  const Rational squared_bound = bound * bound;
  const auto [low, high] = CGAL::to_interval(squared_bound);
  const Interval enclosed(low, high);
  const auto excess = [&]<class T>(T) {
    const Fraction<T> r2 = squared_circumradius<T>(p);
    if constexpr (std::is_same_v<T, Rational>) {
      return r2.numerator - squared_bound * squared_length<T>(a, b) * r2.denominator;
    } else {
      return r2.numerator - enclosed * squared_length<T>(a, b) * r2.denominator;
    }
  };
  return sign_of(excess, num_exact);
}

}  // namespace

ClaimResult check_radius_edge(const Mesh& mesh, const Options& options) {
  Tally empty;
  empty.bins.emplace_back("radius_edge_ratio", "", 0.6, 2.0, 56);
  empty.bins.emplace_back("dihedral_angle", "degrees", 0, 180, 72);
  const Rational bound = typed_decimal(options.radius_edge_bound);
  const Tally tally = tally_over(mesh.cells.size(), options.threads, empty, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints p = points_of(mesh, c);
    const double ratio = radius_edge_ratio(p);
    ++t.num_checked;
    t.bins[0].add(ratio);
    for (const double angle : dihedral_angles_deg(p)) t.bins[1].add(angle);
    if (side_of_bound(p, bound, t.num_exact) < 0) return;
    t.violation({.statement = "radius-edge ratio below the bound",
                 .cells = {c},
                 .vertices = {mesh.cells[c].begin(), mesh.cells[c].end()},
                 .points = {p.begin(), p.end()},
                 .value = ratio,
                 .severity = ratio,
                 .label = mesh.cell_labels.empty() ? 0 : mesh.cell_labels[c]});
  });
  ClaimResult result = result_of("radius_edge", tally);
  result.method = "interval arithmetic, then rationals";
  result.details["bound"] = options.radius_edge_bound;
  result.reason = fmt::format("{} of {} cells at or over {}; largest {:.6g}", result.num_violations,
                              result.num_checked, options.radius_edge_bound, result.histograms[0].maximum);
  return result;
}

}  // namespace podm::verify
