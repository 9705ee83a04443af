#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "image/isosurface_block.h"
#include "image/smooth_interfaces.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

// Points of a block, spread evenly along every direction, so that no plane passes many at once: multiples of
// powers of the root of x^4 = x + 1 (Roberts's sequence in three dimensions).
constexpr std::size_t kPoints = 64;
std::array<Point, kPoints> spread_points() {
  std::array<Point, kPoints> points;
  const auto place = [](double step, std::size_t n) {
    const double at = 0.5 + step * static_cast<double>(n);
    return at - std::floor(at);
  };
  for (std::size_t n = 0; n < kPoints; ++n)
    points[n] = {place(0.8191725133961645, n), place(0.6710436067037893, n), place(0.5497004779019703, n)};
  return points;
}

}  // namespace

std::vector<double> volumes_mm3(const LabelImage& image, const VoxelStrengths& strengths, int threads) {
  static const std::array<Point, kPoints> points = spread_points();
  const LabelGrid<NoReads> grid(image, {});
  std::vector<std::vector<std::uint64_t>> counts(num_threads(threads),
                                                 std::vector<std::uint64_t>(image.labels.size()));
  const auto count_slice = [&](std::size_t slice, std::size_t thread) {
    std::vector<std::uint64_t>& of_thread = counts[thread];
    for (int j = -1; j < image.size[1]; ++j) {
      for (int i = -1; i < image.size[0]; ++i) {
        const Voxel block{i, j, static_cast<int>(slice) - 1};
        const BlockLabels labels = grid.block(block);
        if (labels.is_uniform(labels.corner[0])) {
          of_thread[labels.corner[0]] += kPoints;
          continue;
        }
        const CornerStrengths corners = strengths.block(block);
        for (const Point& f : points) ++of_thread[winner(labels, f, corners).label];
      }
    }
  };
  parallel_for(static_cast<std::size_t>(image.size[2]) + 1, counts.size(), count_slice);
  const double part_mm3 = image.spacing[0] * image.spacing[1] * image.spacing[2] / kPoints;
  std::vector<double> volumes(image.labels.size());
  for (const auto& of_thread : counts)
    for (std::size_t label = 0; label < volumes.size(); ++label)
      volumes[label] += static_cast<double>(of_thread[label]) * part_mm3;
  return volumes;
}

}  // namespace podm
