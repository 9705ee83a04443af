#include "size_census.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "image/isosurface_block.h"
#include "image/working_frame.h"

namespace podm {

namespace {

constexpr std::size_t kMostSamples = std::size_t{1} << 21;
constexpr double kClassesAnOctave = 32;
constexpr int kNoRadius = std::numeric_limits<int>::max();

int class_of(double radius_mm) {
  return std::isfinite(radius_mm) ? static_cast<int>(std::lround(kClassesAnOctave * std::log2(radius_mm)))
                                  : kNoRadius;
}
double radius_of(int number) {
  return number == kNoRadius ? ScalarGrid::kNone : std::exp2(number / kClassesAnOctave);
}

bool is_at_interface(const LabelGrid<NoReads>& grid, const Voxel& v) {
  const LabelIndex own = grid.label(v);
  for (const int step : {-1, 1})
    for (const Voxel& beside :
         {Voxel{v.i + step, v.j, v.k}, Voxel{v.i, v.j + step, v.k}, Voxel{v.i, v.j, v.k + step}})
      if (grid.label(beside) != own) return true;
  return false;
}

struct Counts {
  double voxels = 0, at_interface = 0;
};

}  // namespace

std::optional<SizeCensus> census_of(const LabelImage& image, const SizeOptions& sizes, const SizeGrid* grid) {
  if (grid == nullptr) return std::nullopt;
  return SizeCensus(image, sizes, *grid);
}

double SizeCensus::Places::radius_mm(double factor) const { return std::min(factor * of_image_mm, fixed_mm); }

// What is graded belongs to the image where there is one: a prediction need not tell them apart.
SizeCensus::SizeCensus(const LabelImage& image, const SizeOptions& sizes, const SizeGrid& grid) {
  const Affine to_working = voxels_to_working(image);
  const LabelGrid<NoReads> voxels(image, {});
  int stride = 1;
  while (image.num_voxels() / (static_cast<std::size_t>(stride) * static_cast<std::size_t>(stride) *
                               static_cast<std::size_t>(stride)) >
         kMostSamples)
    ++stride;
  std::map<std::tuple<LabelIndex, int, int>, Counts> counts;
  std::vector<double> of_label(image.labels.size());
  double at_interface = 0;
  for (int k = stride / 2; k < image.size[2]; k += stride)
    for (int j = stride / 2; j < image.size[1]; j += stride)
      for (int i = stride / 2; i < image.size[0]; i += stride) {
        const LabelIndex label = image.voxels[image.index(i, j, k)];
        if (label == kBackground) continue;
        const Point p =
            map(to_working, Point{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        double of_image = grid.radius_far(p) / sizes.image_factor, fixed = grid.radius_near(p);
        largest_mm_ = std::max(largest_mm_, grid.radius_at(p));
        if (sizes.image == nullptr) fixed = std::min(fixed, std::exchange(of_image, ScalarGrid::kNone));
        if (std::isfinite(of_image)) largest_of_image_mm_ = std::max(largest_of_image_mm_, of_image);
        Counts& of_places = counts[{label, class_of(of_image), class_of(fixed)}];
        const double is_beside = is_at_interface(voxels, {i, j, k}) ? 1 : 0;
        ++of_places.voxels;
        of_places.at_interface += is_beside;
        ++of_label[label];
        at_interface += is_beside;
      }
  for (const auto& [key, count] : counts) {
    const auto& [label, of_image, fixed] = key;
    places_.push_back({.label = label,
                       .of_image_mm = radius_of(of_image),
                       .fixed_mm = radius_of(fixed),
                       .volume = count.voxels / of_label[label],
                       .surface = at_interface > 0 ? count.at_interface / at_interface : 0});
  }
  if (places_.empty()) largest_mm_ = ScalarGrid::kNone;  // an object that is finer than the samples
}

}  // namespace podm
