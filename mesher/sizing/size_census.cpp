#include "sizing/size_census.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <utility>

#include "image/working_frame.h"
#include "isosurface/isosurface_block.h"

namespace podm {

namespace {

constexpr std::size_t kMostSamples = std::size_t{1} << 21;
constexpr double kClassesPerOctave = 32;
constexpr int kNoRadius = std::numeric_limits<int>::max();

int class_of(double radius_mm) {
  return std::isfinite(radius_mm) ? static_cast<int>(std::lround(kClassesPerOctave * std::log2(radius_mm)))
                                  : kNoRadius;
}
double radius_of(int number) {
  return number == kNoRadius ? ScalarGrid::kNone : std::exp2(number / kClassesPerOctave);
}

constexpr int kPointsAtInterface = 8;  // per voxel; elsewhere one point per voxel

// Calls visit(axis, step, label beyond) for each face between v and a voxel of another label.
template <class Visit>
void for_each_face(const LabelGrid<NoReads>& grid, const Voxel& v, const Visit& visit) {
  const LabelIndex own = grid.label(v);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1}) {
      std::array<int, 3> to{};
      to[axis] = step;
      const LabelIndex beside = grid.label({v.i + to[0], v.j + to[1], v.k + to[2]});
      if (beside != own) visit(axis, step, beside);
    }
}

struct Counts {
  double volume = 0, surface = 0, border = 0;
};

// The distance of samples along each axis, in voxels.
int stride_of(const LabelImage& image) {
  const auto num_samples = [&](std::size_t stride) {
    return image.num_voxels() / (stride * stride * stride);
  };
  int stride = 1;
  while (num_samples(static_cast<std::size_t>(stride)) > kMostSamples) ++stride;
  return stride;
}

}  // namespace

std::optional<SizeCensus> census_of(const LabelImage& image, const SizeOptions& sizes, const SizeGrid* grid) {
  if (grid == nullptr) return std::nullopt;
  return SizeCensus(image, sizes, *grid);
}

double SizeCensus::Places::radius_mm(double factor) const { return std::min(factor * of_image_mm, fixed_mm); }

// Points within a voxel are random. Zones near interfaces that are narrower than a voxel therefore get their
// share. Graded sizes count as sizes of the size image if there is one: a prediction need not distinguish
// them.
SizeCensus::SizeCensus(const LabelImage& image, const SizeOptions& sizes, const SizeGrid& grid) {
  const Affine to_working = voxels_to_working(image);
  const LabelGrid<NoReads> voxels(image, {});
  std::mt19937_64 random(1);
  const auto drawn = [&random] { return std::ldexp(static_cast<double>(random()), -64) - 0.5; };
  std::map<std::tuple<LabelIndex, int, int>, Counts> counts;
  const auto counts_at = [&](LabelIndex label, const Point& p) -> Counts& {
    double of_image = grid.radius_far(p) / sizes.image_factor, fixed = grid.radius_near(p);
    largest_mm_ = std::max(largest_mm_, std::min(of_image * sizes.image_factor, fixed));
    if (sizes.image == nullptr) fixed = std::min(fixed, std::exchange(of_image, ScalarGrid::kNone));
    if (std::isfinite(of_image)) largest_of_image_mm_ = std::max(largest_of_image_mm_, of_image);
    return counts[{label, class_of(of_image), class_of(fixed)}];
  };
  std::vector<double> of_label(image.labels.size());
  double surface = 0, border = 0;
  const int stride = stride_of(image);
  for (int k = stride / 2; k < image.size[2]; k += stride)
    for (int j = stride / 2; j < image.size[1]; j += stride)
      for (int i = stride / 2; i < image.size[0]; i += stride) {
        const LabelIndex label = image.voxels[image.index(i, j, k)];
        if (label == kBackground) continue;
        const std::array<double, 3> center{static_cast<double>(i), static_cast<double>(j),
                                           static_cast<double>(k)};
        int num_points = 1;
        for_each_face(voxels, {i, j, k}, [&](std::size_t axis, int step, LabelIndex beside) {
          num_points = kPointsAtInterface;
          std::array<double, 3> at = center;
          at[axis] += 0.5 * step;
          const double area = 1 / image.spacing[axis];  // divided by the voxel's volume
          Counts& of_places = counts_at(label, map(to_working, Point{at[0], at[1], at[2]}));
          of_places.surface += area, surface += area;
          if (beside == kBackground) of_places.border += area, border += area;
        });
        for (int n = 0; n < num_points; ++n) {
          const double x = center[0] + drawn(), y = center[1] + drawn(), z = center[2] + drawn();
          counts_at(label, map(to_working, Point{x, y, z})).volume += 1.0 / num_points;
        }
        ++of_label[label];
      }
  for (const auto& [key, count] : counts) {
    const auto& [label, of_image, fixed] = key;
    places_.push_back({.label = label,
                       .of_image_mm = radius_of(of_image),
                       .fixed_mm = radius_of(fixed),
                       .volume = count.volume / of_label[label],
                       .surface = surface > 0 ? count.surface / surface : 0,
                       .border = border > 0 ? count.border / border : 0});
  }
  if (places_.empty()) largest_mm_ = ScalarGrid::kNone;  // the object is finer than the samples
}

}  // namespace podm
