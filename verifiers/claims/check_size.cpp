// Claim size.
//   Statement   Every cell's circumradius R is at most its label's bound r_t (--radius, --radius-of), and at
//               most the bound of the size image (--size-image, times --size-factor) at the circumcenter p.
//               size_field.h defines this bound between voxels.
//               With --size-near A,B=MM:WIDTH, R is at most MM if p is within WIDTH of the interface. The
//               interface is the faces between voxels of A and voxels of B, with background outside the
//               image.
//               With --grade G, R is at most f + G |p - q| + slack for every bound f at a place q. At the
//               center of each voxel f is the bound of its label; at every place it is the bound of the size
//               image there, and MM wherever MM holds near an interface. Moreover, f + 3 G d is a bound at
//               the voxel whose center is nearest to a voxel center of the size image with the bound f, at a
//               distance d. Lengths are mm along the axes of the image.
//   Slack       The slack is the loss that a mesher may have if it keeps grown bounds at nodes and
//               interpolates between them. It has one node per voxel, or one every s voxels along an axis if
//               one every s - 1 voxels gave more than 2^26 nodes. Let D be a voxel's diagonal and [s/2] be
//               s / 2 rounded down. The node n nearest to a voxel q is within [s/2] D and has the bound
//               f + G |q - n|. Bounds at nodes grow no faster than G. The mean distance from n of the nodes
//               around p is at most |p - n| + s D / 2: by Jensen's inequality, as the mean of a squared
//               distance from p is at most a quarter of the squared step along each axis. The mesher
//               therefore grants f + G (2 [s/2] D + |p - q| + s D / 2), and the slack is (2 [s/2] + s/2) G D:
//               half a diagonal times G if s is 1. A place near an interface has its voxel within D / 2 of
//               it. The bound of that voxel is larger by G D / 2, and the distance is longer by D / 2: the
//               slack is G D more. A bound of the size image's own voxels may go to any node that is nearest,
//               by a way of at most d + [s/2] D there and back. A place beyond all nodes counts as the
//               nearest place between them, which is no further from any node. Single precision adds
//               (m + 8) 2^-24 of f + G |p - q|, and of G WIDTH. Here m is the largest number of voxels along
//               an axis, and therefore the largest number of steps of a way.
//   Rests on    The bounds as doubles and the image's radii as floats. Intervals, then rationals, decide
//               R^2 <= r_t^2, in which voxels p lies, and if p is within WIDTH. Grown bounds are compared in
//               doubles, whose rounding is far below the slack. A flat cell has no circumsphere and is a
//               violation.
//   Cost        Linear, about 0.2 us per cell, 2 us with local bounds, and 0.1 us per voxel with a grade;
//               about 80 bytes per face of an interface while the faces are found, and 5 per voxel with a
//               grade.
//   Not proved  That the cells are no smaller than needed.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "claims/circumsphere.h"
#include "claims/claims.h"
#include "claims/graded_sizes.h"
#include "claims/interface_faces.h"
#include "claims/size_field.h"
#include "claims/tally.h"
#include "errors.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

bool is_over(const CellPoints& p, double bound, std::uint64_t& num_exact) {
  const auto excess = [&]<class T>(T) {
    const Fraction<T> r2 = squared_circumradius<T>(p);
    return r2.numerator - T(bound) * T(bound) * r2.denominator;
  };
  const int side = sign_of(excess, num_exact);
  if (side != 0) return side > 0;
  return orientation(p[0], p[1], p[2], p[3], num_exact) == 0;
}

// All bounds on the cells of a mesh.
class SizeBounds {
 public:
  SizeBounds(const Mesh& mesh, const Image* image, const SizeImage* sizes, const Options& options)
      : mesh_(mesh), options_(options) {
    if (sizes != nullptr) field_.emplace(*sizes, options.size_factor, mesh.space);
    for (const InterfaceSize& near : options.interface_sizes) near_.emplace_back(*image, near);
    if (options.grade) graded_.emplace(*image, sizes, near_, options);
    if (image != nullptr) to_voxels_.emplace(image->voxel_to_ras, mesh.space);
  }
  // `graded_` keeps a reference to `near_`.
  SizeBounds(const SizeBounds&) = delete;
  SizeBounds& operator=(const SizeBounds&) = delete;

  const std::vector<InterfaceFaces>& near() const { return near_; }
  const std::optional<GradedSizes>& graded() const { return graded_; }
  bool has_any(CellId c) const { return is_by_place() || of_label(c); }

  // Returns nothing if no bound needs the circumsphere, or if the cell is flat.
  std::optional<Circumsphere> sphere(const CellPoints& p) const {
    return needs_sphere() ? circumsphere(p, *to_voxels_) : std::nullopt;
  }

  bool is_over(CellId c, const CellPoints& p, const std::optional<Circumsphere>& sphere,
               std::uint64_t& num_exact) const {
    const auto radius = of_label(c);
    if (radius && verify::is_over(p, *radius, num_exact)) return true;
    if (!is_by_place()) return false;
    if (orientation(p[0], p[1], p[2], p[3], num_exact) == 0) return true;
    if (field_ && field_->is_over(p, num_exact)) return true;
    return needs_sphere() && is_over_by_sphere(p, sphere, num_exact);
  }

  // Returns the circumradius over the least bound, rounded; 0 if it is not above `known`.
  double severity(CellId c, const CellPoints& p, const std::optional<Circumsphere>& sphere, double radius,
                  double known) const {
    constexpr double kRounding = 1e-12;
    const double limit = radius / known * (1 + kRounding), bound = least(c, p, sphere, limit);
    return bound < limit ? radius / bound : 0;
  }

 private:
  std::optional<double> of_label(CellId c) const {
    return mesh_.cell_labels.empty() ? options_.radius_mm : options_.radius_of_label(mesh_.cell_labels[c]);
  }
  bool needs_sphere() const { return !near_.empty() || graded_; }
  bool is_by_place() const { return field_ || needs_sphere(); }

  bool is_over_by_sphere(const CellPoints& p, const std::optional<Circumsphere>& sphere,
                         std::uint64_t& num_exact) const {
    if (!sphere) return true;
    for (const InterfaceFaces& faces : near_)
      if (verify::is_over(p, faces.near().radius_mm, num_exact) &&
          faces.contains(p, *sphere, *to_voxels_, num_exact))
        return true;
    return graded_ && graded_->is_exceeded_at(sphere->voxel, sphere->radius);
  }

  // Returns the least of a cell's bounds, rounded, if it is below `limit`; otherwise `limit`.
  double least(CellId c, const CellPoints& p, const std::optional<Circumsphere>& sphere, double limit) const {
    double least = std::min(limit, of_label(c).value_or(kUnbounded));
    if (field_) least = std::min(least, field_->bound_at_center(p));
    if (!sphere) return least;
    std::uint64_t num_exact = 0;
    for (const InterfaceFaces& faces : near_)
      if (faces.near().radius_mm < least && faces.contains(p, *sphere, *to_voxels_, num_exact))
        least = faces.near().radius_mm;
    return graded_ ? graded_->bound_at(sphere->voxel, least) : least;
  }

  const Mesh& mesh_;
  const Options& options_;
  std::optional<SizeField> field_;
  std::optional<VoxelMap> to_voxels_;
  std::vector<InterfaceFaces> near_;
  std::optional<GradedSizes> graded_;
};

Tally empty_tally(const Options& options, const SizeImage* sizes) {
  double largest = options.radius_mm.value_or(0);
  if (sizes != nullptr)
    for (const float radius : sizes->radius_mm)
      largest = std::max(largest, options.size_factor * static_cast<double>(radius));
  for (const auto& [label, radius] : options.radius_of) largest = std::max(largest, radius);
  for (const InterfaceSize& near : options.interface_sizes) largest = std::max(largest, near.radius_mm);
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

std::optional<std::string> why_not_run(const Mesh& mesh, const Image* image, const SizeImage* sizes,
                                       const Options& options) {
  if (!options.radius_mm && options.radius_of.empty() && options.interface_sizes.empty() && sizes == nullptr)
    return "no bound given (--radius, --radius-of, --size-image, --size-near)";
  const bool needs_image = !options.interface_sizes.empty() || options.grade;
  if (needs_image && image == nullptr) return "no image given (--image), which --size-near and --grade need";
  if (mesh.space != Space::kVoxel) return std::nullopt;
  if (sizes != nullptr) return "coordinates are voxel indices, possibly of another image than the size image";
  if (needs_image) return "coordinates are voxel indices, and bounds near interfaces and grades are in mm";
  return std::nullopt;
}

// Refuses a size image that bounds no cell, as it would prove nothing. With a grade it may bound cells from
// afar.
void refuse_what_bounds_no_cell(const Mesh& mesh, const SizeImage& sizes, const Options& options) {
  const SizeField field(sizes, options.size_factor, mesh.space);
  const IdRange own = own_cells(mesh);
  std::size_t c = own.begin;
  while (c < own.end && !std::isfinite(field.bound_at_center(points_of(mesh, static_cast<CellId>(c))))) ++c;
  if (sum_over(ranks_of(mesh), c < own.end ? 1 : 0) > 0) return;
  throw RefusedByAll(
      sizes.path +
      ": no cell of the mesh has its circumcentre where the size image has a size above 0 mm; is "
      "it in another space?");
}

nlohmann::json details_of(const SizeBounds& bounds, const Options& options) {
  nlohmann::json details = nlohmann::json::object();
  for (const InterfaceFaces& faces : bounds.near())
    details["size_near"].push_back({{"labels", faces.near().labels},
                                    {"radius_mm", faces.near().radius_mm},
                                    {"width_mm", faces.near().width_mm},
                                    {"faces", faces.size()}});
  if (const auto& graded = bounds.graded())
    details["grade"] = {{"mm_a_mm", *options.grade},
                        {"slack_of_voxels_mm", graded->slack_of_voxels_mm()},
                        {"slack_of_interfaces_mm", graded->slack_of_interfaces_mm()}};
  return details;
}

ClaimResult result_of(const Tally& tally, const SizeBounds& bounds, const Options& options) {
  ClaimResult result = result_of("size", tally);
  result.method = "interval arithmetic, then rationals";
  result.reason = fmt::format("{} of {} cells over their bound; largest circumradius {:.6g} mm",
                              result.num_violations, result.num_checked, result.histograms[0].maximum);
  if (const auto& graded = bounds.graded()) {
    result.method += "; graded bounds in doubles";
    result.reason +=
        fmt::format("; grade to within {:.3g} mm of voxels' bounds", graded->slack_of_voxels_mm());
    if (!bounds.near().empty())
      result.reason += fmt::format(", {:.3g} mm of those near interfaces", graded->slack_of_interfaces_mm());
  }
  result.details() = details_of(bounds, options);
  return result;
}

}  // namespace

ClaimResult check_size(const Mesh& mesh, const Image* image, const SizeImage* sizes, const Options& options) {
  if (const auto reason = why_not_run(mesh, image, sizes, options)) return not_run(*reason);
  if (sizes != nullptr && !options.grade && num_cells(mesh) > 0)
    refuse_what_bounds_no_cell(mesh, *sizes, options);
  const SizeBounds bounds(mesh, image, sizes, options);
  const Tally tally =
      tally_over(own_cells(mesh), options.threads, empty_tally(options, sizes), [&](std::size_t i, Tally& t) {
        const auto c = static_cast<CellId>(i);
        const CellPoints p = points_of(mesh, c);
        const double radius = circumradius(p);
        t.bins[0].add(radius);
        if (!bounds.has_any(c)) return;
        ++t.num_checked;
        const auto sphere = bounds.sphere(p);
        const bool is_over = bounds.is_over(c, p, sphere, t.num_exact);
        const double severity =
            bounds.severity(c, p, sphere, radius, (is_over ? t.worst : t.closest).least_kept());
        if (!is_over && !t.closest.wants(severity)) return;
        Witness witness = cell_witness(mesh, c, "circumradius within the bound", radius, severity);
        is_over ? t.violation(std::move(witness)) : t.closest.add(std::move(witness));
      });
  return result_of(over_ranks(mesh, tally), bounds, options);
}

}  // namespace podm::verify
