#include "lines/exact_points.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "image/working_frame.h"
#include "lines/tie_point.h"

namespace podm {

namespace {

constexpr double kReach = 0.25;   // greatest distance of the exact point, voxels
constexpr double kBeyond = 0.05;  // blocks as near as this are searched, too, voxels
constexpr std::size_t kMostTied = 4;

Point clamped(const Point& f, const Box& box) {
  return {std::clamp(f.x, box.low.x, box.high.x), std::clamp(f.y, box.low.y, box.high.y),
          std::clamp(f.z, box.low.z, box.high.z)};
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
      grid_(image, weights_.get(), image.is_box_flat),
      box_(image.is_box_flat ? std::optional(BoxPlanes(image)) : std::nullopt),
      to_mm_(voxels_to_working(image)),
      from_mm_(inverse(to_mm_)) {}

// Each side takes one label away. On sides no other number of labels is tried: they would tie elsewhere, too.
ExactPoints::Counts ExactPoints::counts_of(SideMask sides, On on) {
  if (sides == 0) return {kMostTied, kMostTied - 1};
  const auto num_sides = static_cast<std::size_t>(std::popcount(sides));
  const std::size_t all = num_sides + (on == On::kCurve ? 1 : 0),
                    count = all < kMostTied ? kMostTied - all : 1;
  return {count, count};
}

std::optional<Point> ExactPoints::in_block(const Voxel& block, const Point& u,
                                           const std::vector<LabelIndex>& labels,
                                           const Counts& counts) const {
  const WeightForms forms(grid_.corners(block));
  SlotMask slots = 0;
  for (std::size_t s = 0; s < forms.size(); ++s)
    if (std::binary_search(labels.begin(), labels.end(), forms.label(s)))
      slots = static_cast<SlotMask>(slots | 1u << s);
  const Box box = grid_.range(block).box();
  const Point start = clamped(u - center(block), box);
  std::optional<Point> found;
  for (std::size_t count = counts.most; count >= counts.least && !found; --count) {
    const SlotMask tied = greatest(forms, slots, start, count);
    if (num_slots(tied) == count) found = tie_point(forms, tied, start, box, kReach);
  }
  return found ? std::optional(center(block) + *found) : std::nullopt;
}

std::optional<SurfacePoint> ExactPoints::near(const Point& q, SideMask sides,
                                              const std::vector<LabelIndex>& labels, On on) const {
  const Counts counts = counts_of(sides, on);
  const SurfacePoint p = on_sides(q, sides);
  const Point u = map(from_mm_, p);
  const Vector beyond{kBeyond, kBeyond, kBeyond};
  const Voxel low = block_at(u - beyond), high = block_at(u + beyond);
  std::optional<Point> nearest;
  double least2 = kReach * kReach;
  for (int k = std::max(low.k, -1); k <= std::min(high.k, grid_.size(2) - 1); ++k)
    for (int j = std::max(low.j, -1); j <= std::min(high.j, grid_.size(1) - 1); ++j)
      for (int i = std::max(low.i, -1); i <= std::min(high.i, grid_.size(0) - 1); ++i) {
        const std::optional<Point> found = in_block({i, j, k}, u, labels, counts);
        if (!found || squared_distance(*found, u) >= least2) continue;
        least2 = squared_distance(*found, u);
        nearest = map(to_mm_, *found);
      }
  return nearest ? std::optional(on_sides(*nearest, p.sides)) : std::nullopt;
}

}  // namespace podm
