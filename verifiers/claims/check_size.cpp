// Claim size.
//   Statement   every cell's circumradius is at most its label's bound r_t (--radius, --radius-of).
//   Rests on    the bounds as doubles: R^2 <= r_t^2 is decided in intervals, then in rationals. A flat cell
//               has no circumsphere and is a violation.
//   Cost        linear, about 0.2 us a cell.
//   Not proved  that the cells are no smaller than needed.
#include <fmt/format.h>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

std::optional<double> bound_of(const Mesh& mesh, CellId c, const Options& options) {
  if (!mesh.cell_labels.empty()) {
    const auto own = options.radius_of.find(mesh.cell_labels[c]);
    if (own != options.radius_of.end()) return own->second;
  }
  return options.radius_mm;
}

bool is_over(const CellPoints& p, double bound, std::uint64_t& num_exact) {
  const auto excess = [&]<class T>(T) {
    const Fraction<T> r2 = squared_circumradius<T>(p);
    return r2.numerator - T(bound) * T(bound) * r2.denominator;
  };
  const int side = sign_of(excess, num_exact);
  if (side != 0) return side > 0;
  return orientation(p[0], p[1], p[2], p[3], num_exact) == 0;
}

Tally empty_tally(const Options& options) {
  double largest = options.radius_mm.value_or(0);
  for (const auto& [label, radius] : options.radius_of) largest = std::max(largest, radius);
  Tally empty;
  empty.bins.emplace_back("circumradius", "mm", 0, largest, 50);
  return empty;
}

}  // namespace

ClaimResult check_size(const Mesh& mesh, const Options& options) {
  if (!options.radius_mm && options.radius_of.empty()) {
    ClaimResult result;
    result.claim = "size";
    result.reason = "no bound given (--radius, --radius-of)";
    return result;
  }
  const Tally tally =
      tally_over(mesh.cells.size(), options.threads, empty_tally(options), [&](std::size_t i, Tally& t) {
        const auto c = static_cast<CellId>(i);
        const CellPoints p = points_of(mesh, c);
        const double radius = circumradius(p);
        t.bins[0].add(radius);
        const auto bound = bound_of(mesh, c, options);
        if (!bound) return;
        ++t.num_checked;
        const double severity = radius / *bound;
        const auto witness = [&] {
          return cell_witness(mesh, c, "circumradius within the bound", radius, severity);
        };
        if (is_over(p, *bound, t.num_exact)) {
          t.violation(witness());
        } else if (t.closest.wants(severity)) {
          t.closest.add(witness());
        }
      });
  ClaimResult result = result_of("size", tally);
  result.method = "interval arithmetic, then rationals";
  result.reason = fmt::format("{} of {} cells over their bound; largest circumradius {:.6g} mm",
                              result.num_violations, result.num_checked, result.histograms[0].maximum);
  return result;
}

}  // namespace podm::verify
