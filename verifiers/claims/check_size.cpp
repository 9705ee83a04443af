// Claim size.
//   Statement   every cell's circumradius is at most its label's bound r_t (--radius, --radius-of), and at
//               most what a size image (--size-image, times --size-factor) has at the circumcentre:
//               size_field.h says what that is between voxels.
//   Rests on    the bounds as doubles, the image's radii as floats: R^2 <= r_t^2, and in which voxels the
//               circumcentre lies, are decided in intervals, then in rationals. A flat cell has no
//               circumsphere and is a violation.
//   Cost        linear, about 0.2 us a cell, and 2 us with an image.
//   Not proved  that the cells are no smaller than needed.
#include <fmt/format.h>

#include <limits>

#include "claims/claims.h"
#include "claims/size_field.h"
#include "claims/tally.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

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

Tally empty_tally(const Options& options, const SizeImage* sizes) {
  double largest = options.radius_mm.value_or(0);
  if (sizes != nullptr)
    for (const float radius : sizes->radius_mm)
      largest = std::max(largest, options.size_factor * static_cast<double>(radius));
  for (const auto& [label, radius] : options.radius_of) largest = std::max(largest, radius);
  Tally empty;
  empty.bins.emplace_back("circumradius", "mm", 0, largest, 50);
  return empty;
}

ClaimResult not_run(const std::string& reason) {
  ClaimResult result;
  result.claim = "size";
  result.reason = reason;
  return result;
}

// Whether either bound is exceeded; where there is none, and in a flat cell, the field's is not.
bool is_over(const CellPoints& p, std::optional<double> of_label, const std::optional<SizeField>& field,
             std::uint64_t& num_exact) {
  if (of_label && is_over(p, *of_label, num_exact)) return true;
  return field && (field->is_over(p, num_exact) || orientation(p[0], p[1], p[2], p[3], num_exact) == 0);
}

}  // namespace

ClaimResult check_size(const Mesh& mesh, const SizeImage* sizes, const Options& options) {
  if (!options.radius_mm && options.radius_of.empty() && sizes == nullptr)
    return not_run("no bound given (--radius, --radius-of, --size-image)");
  if (sizes != nullptr && mesh.space == Space::kVoxel)
    return not_run("coordinates are voxel indices, of another image than the sizes' perhaps");
  std::optional<SizeField> field;
  if (sizes != nullptr) field.emplace(*sizes, options.size_factor, mesh.space);
  const Tally tally = tally_over(
      mesh.cells.size(), options.threads, empty_tally(options, sizes), [&](std::size_t i, Tally& t) {
        const auto c = static_cast<CellId>(i);
        const CellPoints p = points_of(mesh, c);
        const double radius = circumradius(p);
        t.bins[0].add(radius);
        const auto of_label = bound_of(mesh, c, options);
        if (!of_label && !field) return;
        ++t.num_checked;
        const double severity =
            radius / std::min(of_label.value_or(kUnbounded), field ? field->bound_at_center(p) : kUnbounded);
        const auto witness = [&] {
          return cell_witness(mesh, c, "circumradius within the bound", radius, severity);
        };
        if (is_over(p, of_label, field, t.num_exact)) {
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
