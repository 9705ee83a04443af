#include "run/report_on_smoothing.h"

#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cstdint>
#include <utility>
#include <vector>

#include "image/components.h"
#include "image/foreground.h"
#include "isosurface/isosurface_block.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

// The corners of a set and those that share an edge of the block with one of them.
constexpr CornerMask with_neighbours(CornerMask m) {
  return m | (m & 0x55) << 1 | (m & 0xaa) >> 1 | (m & 0x33) << 2 | (m & 0xcc) >> 2 | (m & 0x0f) << 4 |
         (m & 0xf0) >> 4;
}

// The corners of `all` that edges within `all` join to its first corner.
constexpr CornerMask first_piece(CornerMask all) {
  CornerMask piece = all & -all;
  for (int step = 0; step < 7; ++step) piece |= with_neighbours(piece) & all;
  return piece;
}

constexpr Point place_of(unsigned corner) {
  return {static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1),
          static_cast<double>(corner >> 2)};
}

bool keeps_label(const BlockLabels& labels, const CornerWeights& weights, unsigned from, unsigned to) {
  const Vector way = place_of(to) - place_of(from);
  constexpr std::array kEighths{4, 3, 5, 2, 6, 1, 7};  // most paths leave the label near the middle
  return std::all_of(kEighths.begin(), kEighths.end(), [&](int n) {
    return winner(labels, place_of(from) + n / 8.0 * way, weights).label == labels.corner[from];
  });
}

// Calls visit(corner, corner) for corners of one label that are joined only by a path across the block.
template <class Visit>
void for_each_crossing(const BlockLabels& labels, const CornerWeights& weights, const Visit& visit) {
  for (CornerMask left = kAllCorners; left != 0;) {
    const CornerMask of_label = labels.mask(labels.first(left)) & kAllCorners;
    left &= ~of_label;
    for (CornerMask rest = of_label; rest != 0;) {
      const CornerMask piece = first_piece(rest);
      rest &= ~piece;
      for (unsigned a = 0; a < 8; ++a)
        for (unsigned b = 0; b < 8; ++b)
          if ((piece >> a & 1) != 0 && (rest >> b & 1) != 0 && keeps_label(labels, weights, a, b))
            visit(a, b);
    }
  }
}

using Pairs = std::vector<std::pair<Components::Id, Components::Id>>;

// Pairs of components that a path across a block joins. Pairs may occur more than once.
Pairs joined_pairs(const LabelImage& image, const VoxelWeights& weights, const Components& components,
                   int threads) {
  const LabelGrid<NoReads> grid(image, {});
  std::vector<Pairs> of_thread(num_threads(threads));
  parallel_for(
      static_cast<std::size_t>(image.size[2] - 1), of_thread.size(), [&](std::size_t k, std::size_t thread) {
        for (int j = 0; j + 1 < image.size[1]; ++j)
          for (int i = 0; i + 1 < image.size[0]; ++i) {
            const Voxel block{i, j, static_cast<int>(k)};
            const BlockLabels labels = grid.block(block);
            if (labels.is_uniform(labels.corner[0])) continue;
            const auto component = [&](unsigned c) {
              return components.of({block.i + static_cast<int>(c & 1), block.j + static_cast<int>(c >> 1 & 1),
                                    block.k + static_cast<int>(c >> 2)});
            };
            for_each_crossing(labels, weights.block(block), [&](unsigned a, unsigned b) {
              of_thread[thread].emplace_back(component(a), component(b));
            });
          }
      });
  for (std::size_t t = 1; t < of_thread.size(); ++t)
    of_thread[0].insert(of_thread[0].end(), of_thread[t].begin(), of_thread[t].end());
  return std::move(of_thread[0]);
}

struct Counts {
  std::uint64_t of_voxels = 0, smoothed = 0;
};

std::vector<Counts> count_components(const LabelImage& image, const VoxelWeights& weights, int threads) {
  const Components components(image);
  std::vector<Counts> counts(image.labels.size());
  for (Components::Id c = 0; c < components.size(); ++c) {
    ++counts[components[c].label].of_voxels;
    ++counts[components[c].label].smoothed;
  }
  boost::disjoint_sets_with_storage<> sets(components.size());
  for (const auto& [a, b] : joined_pairs(image, weights, components, threads)) {
    if (sets.find_set(a) == sets.find_set(b)) continue;
    sets.link(sets.find_set(a), sets.find_set(b));
    --counts[components[a].label].smoothed;
  }
  return counts;
}

}  // namespace

SmoothingReport report_on_smoothing(const LabelImage& image, double width_mm,
                                    const SmoothInterfaces& smoothed, int threads) {
  const std::vector<std::uint64_t> voxels = count_voxels(image, threads);
  const std::vector<double> volumes = volumes_mm3(image, *smoothed.weights, threads);
  const std::vector<Counts> components = count_components(image, *smoothed.weights, threads);
  const double voxel_mm3 = image.spacing[0] * image.spacing[1] * image.spacing[2];
  SmoothingReport report{.width_mm = width_mm, .labels = {}};
  for (std::size_t label = 1; label < image.labels.size(); ++label)
    report.labels.push_back(
        {.value = image.labels[label].value,
         .voxels_mm3 = static_cast<double>(voxels[label]) * voxel_mm3,
         .smoothed_mm3 = volumes[label],
         .voxels_components = components[label].of_voxels,
         .smoothed_components = components[label].smoothed,
         .is_thin = std::binary_search(smoothed.labels_lost.begin(), smoothed.labels_lost.end(), label)});
  return report;
}

}  // namespace podm
