#include "algorithms/check_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "algorithms/team_size.h"
#include "geometry/affine.h"
#include "image/working_frame.h"

namespace podm {

namespace {

bool is_positive_or_zero(double x) { return std::isfinite(x) && x >= 0; }

using Labels = std::vector<Label>;

bool has_value(Labels::const_iterator begin, Labels::const_iterator end, std::uint32_t value) {
  return std::any_of(begin, end, [value](const Label& label) { return label.value == value; });
}

void check_near(const LabelImage& image, const std::vector<InterfaceSize>& near) {
  for (const InterfaceSize& each : near) {
    if (!(std::isfinite(each.radius_mm) && each.radius_mm > 0) ||
        !(std::isfinite(each.width_mm) && each.width_mm > 0))
      throw InputError("the size at an interface and its width must be positive numbers of mm");
    for (const auto& side : each.labels)
      for (const std::uint32_t value : side)
        if (!has_value(image.labels.begin(), image.labels.end(), value))
          throw InputError(
              fmt::format("size at the interface of label {}: the image has no such label", value));
  }
}

// Readers of files ensure these properties; other callers may not.
void check_size_image(const SizeImage& image) {
  std::size_t voxels = 1;
  for (const int n : image.size) voxels *= static_cast<std::size_t>(std::max(n, 0));
  if (voxels == 0 || voxels != image.radius_mm.size())
    throw InputError(image.path + ": the numbers of radii and voxels of the size image differ");
  if (!(std::abs(determinant(image.voxel_to_ras)) > 0))
    throw InputError(image.path + ": the affine is singular");
  for (const float radius : image.radius_mm)
    if (!is_positive_or_zero(radius))
      throw InputError(image.path + ": radii must be finite and not negative");
}

void check_thin(const SizeOptions& sizes) {
  if (sizes.thin == Thin::kLose && sizes.delta_least_mm > 0)
    throw InputError(fmt::format("{} needs {} keep", spelled("delta-least"), spelled("thin")));
  if (sizes.thin == Thin::kKeep && sizes.target_elements > 0)
    throw InputError(fmt::format("{} keep excludes {}: how many cells mend the layers is known afterwards",
                                 spelled("thin"), spelled("target-elements")));
}

void check_sizes(const LabelImage& image, const SizeOptions& sizes) {
  for (const auto& [value, radius] : sizes.radius_of_mm) {
    if (!has_value(image.labels.begin() + 1, image.labels.end(), value))
      throw InputError("radius of label " + std::to_string(value) + ": the image has no such label");
    if (!(std::isfinite(radius) && radius > 0))
      throw InputError("radius of label " + std::to_string(value) + " must be a positive number of mm");
  }
  check_near(image, sizes.near);
  if (const auto& by_place = sizes.image) check_size_image(*by_place);
  if (!(std::isfinite(sizes.image_factor) && sizes.image_factor > 0))
    throw InputError("the factor of a size image must be a positive number");
  if (sizes.target_elements > 0 && sizes.radius_mm > 0)
    throw InputError("a target number of elements excludes a radius");
  check_thin(sizes);
}

void check_lines(const MeshingOptions& options) {
  const LinesOptions& lines = options.lines;
  if (!lines.are_kept && lines.delta_mm > 0)
    throw InputError(fmt::format("{} needs {}", spelled("lines-delta"), spelled("lines")));
  if (lines.are_kept && options.sizes.thin == Thin::kKeep)
    throw InputError(
        fmt::format("{0} excludes {1} keep: edges of lines may change the topology that {1} keep compares",
                    spelled("lines"), spelled("thin")));
  if (lines.are_kept && options.optimize.is_wanted)
    throw InputError(fmt::format("{} excludes {}: optimisation may remove edges of lines", spelled("lines"),
                                 spelled("optimize")));
}

void check_crossover(const MeshingOptions& options) {
  const Algorithm algorithm = options.algorithm;
  if (options.crossover > 0 && algorithm != Algorithm::kPdrPodm && algorithm != Algorithm::kAuto)
    throw InputError(fmt::format("crossover: algorithm {} has no crossover; only pdr-podm and auto have one",
                                 to_string(algorithm)));
  if (options.crossover > 0 && options.leaves.with_schedule)
    throw InputError("crossover and schedule exclude each other: below the crossover there are no leaves");
}

// Numbers are in the ranges of their declarations; 0 is the default of many, outside of the range.
void check_ranges(const MeshingOptions& options) {
  for_each_option(options, []<class Value>(const Declaration& of, const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> && !std::same_as<Value, bool>) {
      const bool is_unset = value == 0 && *of.unset != 0;
      if (!is_unset && !is_in_range(static_cast<double>(value), of))
        throw InputError(fmt::format("{}: {} is not a {}", of.name, value, range_text(of)));
    }
  });
}

void check_optimization(const MeshingOptions& options) {
  const OptimizeOptions& optimize = options.optimize;
  if (!optimize.is_wanted) return;
  const auto [least, largest] = optimize.dihedral_bounds_deg;
  if (!(least > 0 && least <= 15) || !(largest >= 150 && largest < 180))
    throw InputError(
        "the least dihedral angle must be above 0 and at most 15, the largest at least 150 and below 180");
  if (options.log != nullptr)
    throw InputError(
        "an optimised mesh has no log of operations: the operations of optimisation are not logged");
}

// Readers of files ensure this; other callers may have left the affine out.
void check_affine(const LabelImage& image) {
  const Affine& a = image.voxel_to_ras;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double norm = std::hypot(a[axis], a[4 + axis], a[8 + axis]);
    if (!(norm > 0 && std::abs(norm - image.spacing[axis]) <= 1e-6 * norm))
      throw InputError("the spacing of the image differs from that of its affine (axis " +
                       std::to_string(axis) + ")");
  }
  const double voxel_mm3 = image.spacing[0] * image.spacing[1] * image.spacing[2];
  if (!(std::abs(determinant(a)) > 1e-6 * voxel_mm3)) throw InputError("the affine of the image is singular");
}

void check_box(const LabelImage& image, BoxFaces box) {
  if (image.is_box_flat != (box == BoxFaces::kFlat))
    throw InputError("the option box differs from LabelImage::is_box_flat");
  if (box == BoxFaces::kFlat && is_sheared(image))
    throw InputError(
        fmt::format("{} flat: the affine of the image is sheared; the sides of its box are not at "
                    "right angles",
                    spelled("box")));
}

}  // namespace

void check_voxels(const LabelImage& image) {
  if (image.labels.size() < 2 || image.voxels.empty() || image.voxels.size() != image.num_voxels())
    throw InputError("the image has no foreground");
}

void check_options(const LabelImage& image, const MeshingOptions& options) {
  check_voxels(image);
  check_options_but_voxels(image, options);
}

void check_options_but_voxels(const LabelImage& image, const MeshingOptions& options) {
  check_affine(image);
  check_sizes(image, options.sizes);
  check_ranges(options);
  check_lines(options);
  check_team_size(options.team, options.algorithm);
  check_crossover(options);
  check_optimization(options);
  check_box(image, options.box);
}

}  // namespace podm
