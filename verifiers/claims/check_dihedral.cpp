// Claim dihedral.
//   Statements  Every dihedral angle of every cell is at least the least bound (--min-dihedral), and at most
//               the largest (--max-dihedral), as far as they are given. If neither is given, the bounds that
//               the file promises apply.
//   Rests on    The angle t between facets with the inward normals n and m has cos t = -n.m / |n||m|. So t is
//               below a bound b of 0 to 90 degrees exactly if n.m < 0 and (n.m)^2 > cos^2(b) |n|^2 |m|^2. It
//               is above a bound of 90 to 180 degrees if n.m > 0 and the same inequality holds. Bounds are
//               the decimal numbers as typed. cos^2 is exact or below the true value by less than 1e-70
//               (squared_sine); an angle in that gap would count as a violation. Interval arithmetic decides
//               the clear angles, rationals the rest. A flat cell, whose angles are all 0 or 180 degrees, is
//               a violation of either bound.
//   Cost        Linear, about 1 us per cell, half of it for the histogram.
//   Not proved  Anything about angles between facets of different cells, such as those of an interface.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "claims/claims.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// The facets opposite the vertices of a positive cell, ordered so that their normals point inwards.
constexpr std::array<std::array<std::size_t, 3>, 4> kFacets{{{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

constexpr const char *kLeastAngle = "dihedral angles are at least the bound",
                     *kLargestAngle = "dihedral angles are at most the bound";

struct AngleBounds {
  std::optional<double> least_deg, largest_deg;
};

AngleBounds angle_bounds_of(const Mesh& mesh, const Options& options) {
  if (options.min_dihedral_deg || options.max_dihedral_deg || !mesh.promised_dihedral_deg)
    return {options.min_dihedral_deg, options.max_dihedral_deg};
  return {(*mesh.promised_dihedral_deg)[0], (*mesh.promised_dihedral_deg)[1]};
}

// True if the angle of two facets is beyond a bound: `side` is 1 for the largest, -1 for the least.
bool is_angle_beyond(const CellPoints& p, std::size_t i, std::size_t j, int side, const Constant& cosine2,
                     std::uint64_t& num_exact) {
  const auto normal = [&]<class T>(T, std::size_t k) {
    const auto& [a, b, c] = kFacets[k];
    return cross(difference<T>(p[b], p[a]), difference<T>(p[c], p[a]));
  };
  const auto product = [&]<class T>(T t) { return dot(normal(t, i), normal(t, j)); };
  if (sign_of(product, num_exact) != side) return false;
  return sign_of(
             [&]<class T>(T t) {
               const Vector<T> n = normal(t, i), m = normal(t, j);
               const T nm = dot(n, m);
               return nm * nm - cosine2.in<T>() * dot(n, n) * dot(m, m);
             },
             num_exact) > 0;
}

class CellCheck {
 public:
  explicit CellCheck(const AngleBounds& bounds)
      : has_least_(bounds.least_deg),
        has_largest_(bounds.largest_deg),
        least_(Rational(1) - squared_sine(decimal_as_typed(bounds.least_deg.value_or(0)))),
        largest_(Rational(1) -
                 squared_sine(Rational(180) - decimal_as_typed(bounds.largest_deg.value_or(180)))) {}

  /// Returns the statement that the cell breaks, or null.
  const char* broken_by(const CellPoints& p, std::uint64_t& num_exact) const {
    if (orientation(p[0], p[1], p[2], p[3], num_exact) == 0) return has_least_ ? kLeastAngle : kLargestAngle;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        if (has_least_ && is_angle_beyond(p, i, j, -1, least_, num_exact)) return kLeastAngle;
        if (has_largest_ && is_angle_beyond(p, i, j, 1, largest_, num_exact)) return kLargestAngle;
      }
    }
    return nullptr;
  }

 private:
  bool has_least_, has_largest_;
  Constant least_, largest_;  // squared cosines
};

std::string text_of_angles(const AngleBounds& bounds) {
  if (!bounds.largest_deg) return fmt::format("under {} degrees", *bounds.least_deg);
  if (!bounds.least_deg) return fmt::format("over {} degrees", *bounds.largest_deg);
  return fmt::format("under {} or over {} degrees", *bounds.least_deg, *bounds.largest_deg);
}

}  // namespace

ClaimResult check_dihedral(const Mesh& mesh, const Options& options) {
  const AngleBounds bounds = angle_bounds_of(mesh, options);
  if (!bounds.least_deg && !bounds.largest_deg) {
    ClaimResult result;
    result.claim = "dihedral";
    result.reason = "no bound given (--min-dihedral, --max-dihedral), and the file promises none";
    return result;
  }
  Tally empty;
  empty.bins.push_back(bins_of_degrees("dihedral_angle"));
  const CellCheck check(bounds);
  const Tally tally = tally_over(own_cells(mesh), options.threads, empty, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints p = points_of(mesh, c);
    const auto angles = dihedral_angles_deg(p);
    for (const double angle : angles) t.bins[0].add(angle);
    ++t.num_checked;
    const double least = *std::min_element(angles.begin(), angles.end()),
                 largest = *std::max_element(angles.begin(), angles.end());
    const char* const broken = check.broken_by(p, t.num_exact);
    // distance from a bound; positive beyond it
    const double under = bounds.least_deg ? *bounds.least_deg - least : -180,
                 over = bounds.largest_deg ? largest - *bounds.largest_deg : -180;
    const double severity = std::max(under, over);
    const auto witness = [&](const char* statement) {
      return cell_witness(mesh, c, statement, under > over ? least : largest, severity);
    };
    if (broken != nullptr) {
      t.violation(witness(broken));
    } else if (t.closest.wants(severity)) {
      t.closest.add(witness(under > over ? kLeastAngle : kLargestAngle));
    }
  });
  ClaimResult result = result_of("dihedral", over_ranks(mesh, tally));
  result.method = "interval arithmetic, then rationals";
  result.details()["least_degrees"] = bounds.least_deg ? nlohmann::json(*bounds.least_deg) : nlohmann::json();
  result.details()["largest_degrees"] =
      bounds.largest_deg ? nlohmann::json(*bounds.largest_deg) : nlohmann::json();
  result.reason = fmt::format("{} of {} cells with an angle {}; {:.6g} to {:.6g}", result.num_violations,
                              result.num_checked, text_of_angles(bounds), result.histograms[0].minimum,
                              result.histograms[0].maximum);
  return result;
}

}  // namespace podm::verify
