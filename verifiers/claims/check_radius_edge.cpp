// Claim radius_edge.
//   Statement   Every cell has circumradius / shortest edge < bound (by default 1.93).
//   Rests on    The coordinates alone. Let the bound b be the decimal number as typed. The claim for a cell
//               is R^2 < b^2 l^2, both sides rational in the coordinates. Interval arithmetic decides the
//               clear cells, rationals the rest. A flat cell has no circumsphere and is a violation.
//   Cost        Linear, about 0.7 us per cell, most of it for the histograms.
//   Not proved  Anything about dihedral angles: slivers satisfy the bound. The histogram of dihedral angles
//               is reported.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// Returns the sign of R^2 - bound^2 l^2; a flat cell is above any bound.
int side_of_bound(const CellPoints& p, const Constant& squared_bound, std::uint64_t& num_exact) {
  return sign_of(
      [&]<class T>(T) {
        const Fraction<T> r2 = squared_circumradius<T>(p);
        return r2.numerator - squared_bound.in<T>() * squared_shortest_edge<T>(p) * r2.denominator;
      },
      num_exact);
}

}  // namespace

ClaimResult check_radius_edge(const Mesh& mesh, const Options& options) {
  Tally empty;
  empty.bins.emplace_back("radius_edge_ratio", "", 0.6, 2.0, 56);
  empty.bins.push_back(bins_of_degrees("dihedral_angle"));
  const Rational bound = decimal_as_typed(options.radius_edge_bound);
  const Constant squared_bound(bound * bound);
  const Tally tally = tally_over(own_cells(mesh), options.threads, empty, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints p = points_of(mesh, c);
    const double ratio = radius_edge_ratio(p);
    ++t.num_checked;
    t.bins[0].add(ratio);
    for (const double angle : dihedral_angles_deg(p)) t.bins[1].add(angle);
    const bool is_below = side_of_bound(p, squared_bound, t.num_exact) < 0;
    const auto witness = [&] {
      return cell_witness(mesh, c, "radius-edge ratio below the bound", ratio, ratio);
    };
    if (!is_below) {
      t.violation(witness());
    } else if (t.closest.wants(ratio)) {
      t.closest.add(witness());
    }
  });
  ClaimResult result = result_of("radius_edge", over_ranks(mesh, tally));
  result.method = "interval arithmetic, then rationals";
  result.details()["bound"] = options.radius_edge_bound;
  result.reason = fmt::format("{} of {} cells at or over {}; largest {:.6g}", result.num_violations,
                              result.num_checked, options.radius_edge_bound, result.histograms[0].maximum);
  return result;
}

}  // namespace podm::verify
