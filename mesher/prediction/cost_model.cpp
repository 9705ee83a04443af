#include "prediction/cost_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "algorithms/check_options.h"
#include "algorithms/memory_model.h"
#include "algorithms/team_size.h"
#include "image/image_by_bricks.h"
#include "image/interface_sides.h"
#include "image/rows_of_image.h"
#include "runtime/parallel_for.h"
#include "sizing/default_sizes.h"
#include "sizing/make_size_grid.h"

namespace podm {

namespace {

// Adds the sides by label, including the background, for the same pairs of voxels.
void add_sides(const LabelImage& image, std::size_t axis, int lag, int j, int k,
               std::vector<std::uint64_t>& sides) {
  const int size = image.size[0], position = axis == 0 ? 0 : axis == 1 ? j : k;
  const LabelIndex* const row = &image.voxels[image.index(0, j, k)];
  const auto add = [&](LabelIndex a, LabelIndex b) {
    if (a == b) return;
    ++sides[a];
    ++sides[b];
  };
  if (axis == 0) {
    for (int i = 0; i < size; ++i) {
      add(row[i], i + lag < size ? row[i + lag] : kBackground);
      if (i < lag) add(row[i], kBackground);
    }
    return;
  }
  const std::size_t step =
      image.index(0, axis == 1 ? 1 : 0, axis == 1 ? 0 : 1) * static_cast<std::size_t>(lag);
  const bool is_last = position + lag >= image.size[axis];
  for (int i = 0; i < size; ++i) {
    add(row[i], is_last ? kBackground : row[static_cast<std::size_t>(i) + step]);
    if (position < lag) add(row[i], kBackground);
  }
}

}  // namespace

CostModel::CostModel(const LabelImage& image, int threads, std::optional<SizeCensus> census)
    : image_(image), threads_(threads), census_(std::move(census)) {
  for (const std::uint64_t n : count_voxels(image, threads))
    volume_of_label_mm3_.push_back(static_cast<double>(n) * image.spacing[0] * image.spacing[1] *
                                   image.spacing[2]);
  volume_of_label_mm3_[kBackground] = 0;
  volume_mm3_ = std::accumulate(volume_of_label_mm3_.begin(), volume_of_label_mm3_.end(), 0.0);
}

double CostModel::area_along_mm2(std::size_t axis, std::size_t lag) const {
  auto& known = area_along_mm2_[axis][lag];
  if (known) return *known;
  const double face_mm2 = image_.spacing[(axis + 1) % 3] * image_.spacing[(axis + 2) % 3];
  // The sides between neighbors stand for those at all lags. Parts that are thinner than samples then count,
  // so the cells of such parts are overestimated.
  if (const ImageByBricks* in_file = by_bricks(image_))
    return static_cast<double>(in_file->sides[axis]) * face_mm2;
  const std::uint64_t sides = sum_over_rows(
      image_, threads_, std::uint64_t{0},
      [&](std::uint64_t& sum, int j, int k) { sum += count_sides(image_, axis, kLags[lag], j, k); });
  known = static_cast<double>(sides) / kLags[lag] * face_mm2;
  return *known;
}

template <class Add>
void CostModel::interpolate(double distance_mm, const Add& add) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lag = std::clamp(distance_mm / image_.spacing[axis], 1.0, static_cast<double>(kLags.back()));
    std::size_t low = 0;
    while (low + 2 < kLags.size() && lag >= kLags[low + 1]) ++low;
    const double share = (lag - kLags[low]) / (kLags[low + 1] - kLags[low]);
    add(axis, low, 1 - share);
    if (share > 0) add(axis, low + 1, share);
  }
}

double CostModel::area_mm2(double distance_mm) const {
  double area_mm2 = 0;
  interpolate(distance_mm, [&](std::size_t axis, std::size_t lag, double share) {
    area_mm2 += share * area_along_mm2(axis, lag);
  });
  return area_mm2;
}

std::vector<double> CostModel::areas_along_mm2(std::size_t axis, std::size_t lag) const {
  const LabelCounts none{std::vector<std::uint64_t>(image_.labels.size())};
  const auto sides = sum_over_rows(image_, threads_, none, [&](LabelCounts& counts, int j, int k) {
    add_sides(image_, axis, kLags[lag], j, k, counts.of_label);
  });
  const double face_mm2 = image_.spacing[(axis + 1) % 3] * image_.spacing[(axis + 2) % 3];
  std::vector<double> areas_mm2;
  for (const std::uint64_t n : sides.of_label)
    areas_mm2.push_back(static_cast<double>(n) / kLags[lag] * face_mm2);
  return areas_mm2;
}

std::vector<double> CostModel::areas_by_label_mm2(double distance_mm) const {
  std::vector<double> areas_mm2(image_.labels.size());
  interpolate(distance_mm, [&](std::size_t axis, std::size_t lag, double share) {
    const std::vector<double> along = areas_along_mm2(axis, lag);
    for (std::size_t label = 0; label < areas_mm2.size(); ++label) areas_mm2[label] += share * along[label];
  });
  return areas_mm2;
}

// The radius with which the label has the same number of cells as its places have with their own radii;
// infinity if unbounded.
double CostModel::mean_radius_mm(LabelIndex label, const SizeOptions& sizes) const {
  const double asked_mm = radius_mm_of(sizes, image_.labels[label]);
  const double of_label = asked_mm > 0 ? asked_mm : std::numeric_limits<double>::infinity();
  if (!census_) return of_label;
  double density = 0;
  for (const SizeCensus::Places& places : census_->places())
    if (places.label == label)
      density += places.volume * std::pow(std::min(of_label, places.radius_mm(sizes.image_factor)), -3);
  return std::cbrt(1 / density);
}

// The ratio of the number of cells at interfaces to that where delta alone decides. `share` selects the
// interfaces.
double CostModel::surface_growth(const SizeOptions& sizes, double SizeCensus::Places::*share) const {
  if (!census_) return 1;
  double growth = 0, shares = 0;
  for (const SizeCensus::Places& places : census_->places()) {
    const double ratio = sizes.delta_mm / (kSpacingOverRadius * places.radius_mm(sizes.image_factor));
    growth += places.*share * std::max(1.0, ratio * ratio);
    shares += places.*share;
  }
  return shares > 0 ? growth : 1;
}

double CostModel::cells(const SizeOptions& sizes) const {
  const double delta = sizes.delta_mm, area = area_mm2(kSeenOverDelta * delta);
  double cells = kSurfaceCells * squares(sizes);
  for (std::size_t i = 1; i < image_.labels.size(); ++i)
    if (const double volume_mm3 = volume_of_label_mm3_[i]; volume_mm3 > 0)
      cells += volume_mm3 / volume_mm3_ *
               volume_cells(volume_mm3_, area, mean_radius_mm(static_cast<LabelIndex>(i), sizes), delta);
  return cells;
}

double CostModel::growth_with(const ThinLayers& layers, const SizeOptions& sizes) const {
  const double uniform = cells(sizes);
  double sum = 0;
  for (const auto& [delta_mm, share] : shares_of_deltas(image_, layers.deltas)) {
    SizeOptions there = sizes;
    there.delta_mm = delta_mm;
    sum += share * cells(there);
  }
  return uniform > 0 ? std::max(1.0, sum / uniform) : 1;
}

std::vector<double> CostModel::cells_by_label(const SizeOptions& sizes) const {
  const std::vector<double> areas_mm2 = areas_by_label_mm2(kSeenOverDelta * sizes.delta_mm);
  std::vector<double> by_label(image_.labels.size());
  for (std::size_t i = 1; i < by_label.size(); ++i)
    if (const double volume_mm3 = volume_of_label_mm3_[i]; volume_mm3 > 0)
      by_label[i] = CostModel::cells(volume_mm3, areas_mm2[i],
                                     mean_radius_mm(static_cast<LabelIndex>(i), sizes), sizes.delta_mm);
  const double sum = std::accumulate(by_label.begin(), by_label.end(), 0.0), all = cells(sizes);
  for (double& of_label : by_label) of_label *= sum > 0 ? all / sum : 0;
  return by_label;
}

double CostModel::squares(const SizeOptions& sizes) const {
  return area_mm2(kSeenOverDelta * sizes.delta_mm) / (sizes.delta_mm * sizes.delta_mm) *
         surface_growth(sizes, &SizeCensus::Places::surface);
}

double CostModel::background_cells(const SizeOptions& sizes) const {
  return kOutsideCells * areas_by_label_mm2(kSeenOutsideOverDelta * sizes.delta_mm)[kBackground] /
         (sizes.delta_mm * sizes.delta_mm) * surface_growth(sizes, &SizeCensus::Places::border);
}

double CostModel::cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm) {
  return kSurfaceCells * area_mm2 / (delta_mm * delta_mm) +
         volume_cells(volume_mm3, area_mm2, radius_mm, delta_mm);
}

// A shell of the ball at depth z has the volume A (1 - z / depth)^2 dz. Its cells have the radius u = first +
// kGrowth z. The integrand is therefore (a - b u)^2 / u^3.
double CostModel::volume_cells(double volume_mm3, double area_mm2, double radius_mm, double delta_mm) {
  const double first = std::min(radius_mm, kFirstOverDelta * delta_mm);
  if (area_mm2 == 0) return kVolumeCells * volume_mm3 / std::pow(radius_mm, 3);
  const double growth_to_center = kGrowth * 3 * volume_mm3 / area_mm2;
  if (growth_to_center < 1e-3 * first)  // the integral would lose all digits to cancellation
    return kVolumeCells * std::max(volume_mm3, 0.0) / std::pow(first, 3);
  const double last = std::min(radius_mm, first + growth_to_center);
  const double core = kVolumeCells * volume_mm3 * std::pow((1 - (last - first) / growth_to_center) / last, 3);
  if (last == first) return core;
  // In units of the first radius, as the square of a tiny radius would underflow to 0.
  const double b = first / growth_to_center, a = 1 + b;
  const auto integral_to = [&](double u) {
    return -a * a / (2 * u * u) + 2 * a * b / u + b * b * std::log(u);
  };
  return kVolumeCells * area_mm2 / (kGrowth * first * first) * (integral_to(last / first) - integral_to(1)) +
         core;
}

std::optional<ThinLayers> kept_layers(const LabelImage& image, const SizeOptions& sizes, int threads) {
  if (sizes.thin == Thin::kLose) return std::nullopt;
  ThinLayers layers = find_thin_layers(image, sizes, sizes.delta_mm, threads);
  layers.deltas.graded();
  return layers;
}

Estimate estimate(const LabelImage& image, const MeshingOptions& options) {
  check_voxels(image);
  return estimate(image, options, make_size_grid(image, options.sizes, loop_threads(options.team)).get());
}

Estimate estimate(const LabelImage& image, const MeshingOptions& options, const SizeGrid* grid,
                  int num_ranks) {
  double cells = static_cast<double>(options.sizes.target_elements), delta_mm = options.sizes.delta_mm;
  if (options.sizes.target_elements == 0) {
    SizeOptions sizes = options.sizes;
    const CostModel model(image, loop_threads(options.team), census_of(image, sizes, grid));
    delta_mm = sizes.delta_mm = delta_mm_for(image, sizes, model.census());
    cells = model.cells(sizes);
    if (const auto layers = kept_layers(image, sizes, loop_threads(options.team)))
      cells *= model.growth_with(*layers, sizes);
  }
  const ImageByBricks* in_file = by_bricks(image);
  const double bytes_of_image =
      in_file != nullptr
          ? static_cast<double>(sizeof(LabelIndex) * in_file->label_of_brick.size() +
                                bytes_of_bricks(*in_file, num_ranks))
          : static_cast<double>(image.num_voxels()) * (sizeof(LabelIndex) + kTransformBytesPerVoxel);
  return {cells,
          cells * kPeakBytesPerMeshCell + bytes_of_image +
              static_cast<double>(bytes_of_size_grid(image, options.sizes)),
          delta_mm};
}

}  // namespace podm
