#include "lines/exact_points.h"

#include <algorithm>
#include <cmath>

#include "image/working_frame.h"
#include "lines/tie_point.h"

namespace podm {

namespace {

constexpr double kReach = 0.25;   // greatest distance of the exact point, voxels
constexpr double kBeyond = 0.05;  // blocks as near as this are searched, too, voxels
constexpr std::size_t kMostTied = 4;
constexpr Box kBlock{{0, 0, 0}, {1, 1, 1}};

Point clamped(const Point& f) {
  return {std::clamp(f.x, 0.0, 1.0), std::clamp(f.y, 0.0, 1.0), std::clamp(f.z, 0.0, 1.0)};
}

Voxel block_at(const Point& u) {
  return {static_cast<int>(std::floor(u.x)), static_cast<int>(std::floor(u.y)),
          static_cast<int>(std::floor(u.z))};
}

// Keeps the `count` slots of greatest weight at f.
SlotMask greatest(const WeightForms& forms, SlotMask slots, const Point& f, std::size_t count) {
  while (num_slots(slots) > count) {
    std::size_t least = 0;
    double least_weight = 1e300;
    for (std::size_t s = 0; s < forms.size(); ++s) {
      if ((slots >> s & 1) == 0 || forms.weight(s, f) >= least_weight) continue;
      least = s;
      least_weight = forms.weight(s, f);
    }
    slots = static_cast<SlotMask>(slots & ~(1u << least));
  }
  return slots;
}

}  // namespace

ExactPoints::ExactPoints(const LabelImage& image, std::shared_ptr<const VoxelWeights> weights)
    : weights_(std::move(weights)),
      grid_(image, weights_.get(), false),
      to_mm_(voxels_to_working(image)),
      from_mm_(inverse(to_mm_)) {}

std::optional<Point> ExactPoints::in_block(const Voxel& block, const Point& u,
                                           const std::vector<LabelIndex>& labels) const {
  const WeightForms forms(grid_.corners(block));
  SlotMask slots = 0;
  for (std::size_t s = 0; s < forms.size(); ++s)
    if (std::binary_search(labels.begin(), labels.end(), forms.label(s)))
      slots = static_cast<SlotMask>(slots | 1u << s);
  if (num_slots(slots) < 3) return std::nullopt;
  const Point start = clamped(u - center(block));
  std::optional<Point> found;
  for (std::size_t count : {kMostTied, kMostTied - 1}) {
    const SlotMask tied = greatest(forms, slots, start, count);
    if (!found && num_slots(tied) == count) found = tie_point(forms, tied, start, kBlock, kReach);
  }
  return found ? std::optional(center(block) + *found) : std::nullopt;
}

std::optional<Point> ExactPoints::near(const Point& p, const std::vector<LabelIndex>& labels) const {
  const Point u = map(from_mm_, p);
  const Vector beyond{kBeyond, kBeyond, kBeyond};
  const Voxel low = block_at(u - beyond), high = block_at(u + beyond);
  std::optional<Point> nearest;
  double least2 = kReach * kReach;
  for (int k = std::max(low.k, -1); k <= std::min(high.k, grid_.size(2) - 1); ++k)
    for (int j = std::max(low.j, -1); j <= std::min(high.j, grid_.size(1) - 1); ++j)
      for (int i = std::max(low.i, -1); i <= std::min(high.i, grid_.size(0) - 1); ++i) {
        const std::optional<Point> found = in_block({i, j, k}, u, labels);
        if (!found || squared_distance(*found, u) >= least2) continue;
        least2 = squared_distance(*found, u);
        nearest = map(to_mm_, *found);
      }
  return nearest;
}

}  // namespace podm
