#include "prediction/radius_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "podm/errors.h"
#include "sizing/make_size_grid.h"

namespace podm {

namespace {

// The factor by which the model may err before a target is refused, and the largest factor by which the cells
// of one mesh correct the prediction for the next.
constexpr double kErrorAllowed = 1.3, kMostCorrection = 10;

bool has_fixed_sizes(const SizeOptions& sizes) { return !sizes.near.empty() || !sizes.radius_of_mm.empty(); }

}  // namespace

RadiusSearch::RadiusSearch(const LabelImage& image, const SizeOptions& asked, int threads)
    : model_(image, threads, census_of(image, asked, make_size_grid(image, asked, threads).get())),
      asked_(asked),
      largest_mm_(std::hypot(image.size[0] * image.spacing[0], image.size[1] * image.spacing[1],
                             image.size[2] * image.spacing[2])),
      radius_mm_(radius_for(static_cast<double>(asked.target_elements))) {
  if (!has_fixed_sizes(asked)) return;
  const double least = model_.cells(at(largest_mm_));
  if (least > kErrorAllowed * static_cast<double>(asked.target_elements))
    throw InputError(fmt::format(
        "a target of {} elements: sizes near interfaces and of single labels{} alone need about {:.0f}",
        asked.target_elements, asked.delta_mm > 0 ? ", with this delta," : "", least));
}

SizeOptions RadiusSearch::at(double radius_mm) const {
  SizeOptions sizes = asked_;
  sizes.radius_mm = radius_mm;
  const double largest = sizes.image != nullptr ? model_.census()->largest_of_image_mm() : 0;
  if (largest > 0) sizes.image_factor = radius_mm / largest;
  if (sizes.delta_mm <= 0) sizes.delta_mm = radius_mm / 2;
  return sizes;
}

// The number of cells decreases as the radius grows.
double RadiusSearch::radius_for(double cells) const {
  double low = 1e-9 * largest_mm_, high = largest_mm_;
  while (high / low > 1.0001) {
    const double radius = std::sqrt(low * high);
    (model_.cells(at(radius)) > cells ? low : high) = radius;
  }
  return high;
}

// The first mesh gives the factor by which the model errs. Further meshes show how the number of cells
// depends on the radius. This is no power law where a sheet appears or vanishes with the radius. The search
// then interpolates between a mesh with too many cells and one with too few.
bool RadiusSearch::learn(double cells) {
  const double target = static_cast<double>(asked_.target_elements);
  const Sample mesh{radius_mm_, cells};
  std::optional<Sample>& near = cells > target ? too_many_ : too_few_;
  const std::optional<Sample> before = std::exchange(near, mesh);
  const auto to_target = [&](double exponent) { return std::pow(target / cells, 1 / exponent); };
  const auto exponent_between = [](const Sample& a, const Sample& b) {
    return std::log(a.cells / b.cells) / std::log(a.radius_mm / b.radius_mm);
  };
  if (too_many_ && too_few_) {
    radius_mm_ *= to_target(exponent_between(*too_many_, *too_few_));
  } else if (before) {
    radius_mm_ *= to_target(std::clamp(exponent_between(*before, mesh), -4.0, -0.5));
    radius_mm_ = std::min(radius_mm_, largest_mm_);
  } else {
    const double correction = std::clamp(target / cells, 1 / kMostCorrection, kMostCorrection);
    radius_mm_ = radius_for(correction * model_.cells(at(radius_mm_)));
  }
  return radius_mm_ != mesh.radius_mm;
}

}  // namespace podm
