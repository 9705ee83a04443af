// Claim radius_edge.
//   Statement   Every cell has circumradius / shortest edge < bound (by default 1.93).
//   Rests on    The coordinates alone. Let the bound b be the decimal number as typed. The claim for a cell
//               is R^2 < b^2 l^2, both sides rational in the coordinates. Interval arithmetic decides the
//               clear cells, rationals the rest. A flat cell has no circumsphere and is a violation.
//   Cost        Linear, about 0.7 us per cell, most of it for the histograms.
//   Not proved  Anything about dihedral angles: slivers satisfy the bound. The histogram of dihedral angles
//               is reported. If the mesh keeps lines (near_lines.h), cells near them are counted. The bound
//               is the same there.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "claims/near_lines.h"
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

struct RatioTally : Tally {
  std::uint64_t num_near = 0;  // near lines
  double largest_near = 0;

  void add(const RatioTally& other) {
    Tally::add(other);
    num_near += other.num_near;
    largest_near = std::max(largest_near, other.largest_near);
  }
  template <class Stream>
  void transfer(Stream& stream) {
    Tally::transfer(stream);
    stream(num_near, largest_near);
  }
};

// Adds the cells near lines to the result.
void report_lines(const RatioTally& tally, ClaimResult& result) {
  result.details()["near_lines"] = {{"cells", tally.num_near}, {"largest_ratio", tally.largest_near}};
  result.reason += fmt::format("; of {} cells near lines {:.6g}", tally.num_near, tally.largest_near);
}

}  // namespace

ClaimResult check_radius_edge(const Mesh& mesh, const Adjacency& adjacency, const Options& options) {
  RatioTally empty;
  empty.bins.emplace_back("radius_edge_ratio", "", 0.6, 2.0, 56);
  empty.bins.push_back(bins_of_degrees("dihedral_angle"));
  const Rational bound = decimal_as_typed(options.radius_edge_bound);
  const Constant squared_bound(bound * bound);
  const NearLines near_lines(mesh, adjacency, options);
  const auto check = [&](std::size_t i, RatioTally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints p = points_of(mesh, c);
    const double ratio = radius_edge_ratio(p);
    ++t.num_checked;
    if (near_lines.has(mesh.cells[c])) {
      ++t.num_near;
      t.largest_near = std::max(t.largest_near, ratio);
    }
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
  };
  const RatioTally tally = over_ranks(mesh, tally_over(own_cells(mesh), options.threads, empty, check));
  ClaimResult result = result_of("radius_edge", tally);
  result.method = "interval arithmetic, then rationals";
  result.details()["bound"] = options.radius_edge_bound;
  result.reason = fmt::format("{} of {} cells at or over {}; largest {:.6g}", result.num_violations,
                              result.num_checked, options.radius_edge_bound, result.histograms[0].maximum);
  if (near_lines.are_kept()) report_lines(tally, result);
  return result;
}

}  // namespace podm::verify
