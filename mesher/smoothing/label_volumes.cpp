#include <array>
#include <cstdint>

#include "geometry/spread_point.h"
#include "isosurface/isosurface_block.h"
#include "runtime/parallel_for.h"
#include "smoothing/smooth_interfaces.h"

namespace podm {

namespace {

// The points in a block. They are spread such that no plane passes many of them at once.
constexpr std::size_t kPoints = 64;

std::array<Point, kPoints> points_of_block() {
  std::array<Point, kPoints> points;
  for (std::size_t n = 0; n < kPoints; ++n) points[n] = spread_point(n);
  return points;
}

}  // namespace

std::vector<double> volumes_mm3(const LabelImage& image, const VoxelWeights& weights, int threads) {
  static const std::array<Point, kPoints> points = points_of_block();
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
        const CornerWeights corners = weights.block(block);
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
