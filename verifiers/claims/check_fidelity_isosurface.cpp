#include "claims/check_fidelity_isosurface.h"

#include <cmath>
#include <numeric>

namespace podm::verify {

namespace {

constexpr double kVoxelError = 1e-5;  // of bisection
constexpr double kSameWeight = 1e-4;  // labels whose weights are this close meet at a point
constexpr double kWeightOvershoot = 0.02, kOvershoot = 1.01;
constexpr int kMaxProjections = 3;
// A step along an axis is tried unless it is longer than the distance found by this factor.
constexpr double kStepSquared = 4 * 4;

Point along(const Point& a, const Point& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

std::vector<std::uint32_t> first_ids(std::size_t count) {
  std::vector<std::uint32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0U);
  return ids;
}

}  // namespace

// Voxels outside the grid are background; one voxel of a pair may be outside.
Midpoints::Midpoints(const Image& image, const ImageFrame& frame, const LabelFunction& label_function) {
  const std::array<std::size_t, 3> stride{
      1, static_cast<std::size_t>(image.size[0]),
      static_cast<std::size_t>(image.size[0]) * static_cast<std::size_t>(image.size[1])};
  std::size_t index = 0;
  const auto add = [&](const std::array<int, 3>& upper, std::size_t axis, std::uint32_t below,
                       std::uint32_t above) {
    if (below == above) return;
    std::array<int, 3> lower = upper;
    --lower[axis];
    Point u{static_cast<double>(lower[0]), static_cast<double>(lower[1]), static_cast<double>(lower[2])};
    u[axis] += label_function.change_after(lower, axis);
    midpoints_.push_back({frame.voxels_to_world(u), {below, above}, static_cast<std::uint8_t>(axis)});
  };
  std::array<int, 3> v{};
  for (v[2] = 0; v[2] < image.size[2]; ++v[2])
    for (v[1] = 0; v[1] < image.size[1]; ++v[1])
      for (v[0] = 0; v[0] < image.size[0]; ++v[0], ++index)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::uint32_t label = image.voxels[index];
          add(v, axis, v[axis] > 0 ? image.voxels[index - stride[axis]] : 0, label);
          if (v[axis] + 1 < image.size[axis]) continue;
          std::array<int, 3> beyond = v;
          ++beyond[axis];
          add(beyond, axis, label, 0);
        }
}

// The property that counts as the same on both sides: the label itself, or whether it is `label`.
struct IsosurfaceDistance::Region {
  bool is_of_label = false;
  std::uint32_t label = 0;

  std::uint32_t side(std::uint32_t at) const { return is_of_label ? (at == label ? 1 : 0) : at; }
};

IsosurfaceDistance::IsosurfaceDistance(const Image& image, const ImageFrame& frame,
                                       const Midpoints& midpoints, const LabelFunction& label_function)
    : frame_(frame),
      midpoints_(midpoints),
      label_function_(label_function),
      tree_(midpoints, first_ids(midpoints.all().size())) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Point& step = steps_[2 * axis + (sign > 0 ? 1 : 0)];
      for (std::size_t row = 0; row < 3; ++row) step[row] = sign * image.voxel_to_ras[4 * row + axis];
    }
  std::map<std::uint32_t, std::vector<std::uint32_t>> ids;
  for (std::uint32_t i = 0; i < midpoints.all().size(); ++i)
    for (const std::uint32_t label : midpoints.all()[i].labels)
      if (label != 0) ids[label].push_back(i);
  for (auto& [label, of_label] : ids) tree_of_label_.try_emplace(label, midpoints, std::move(of_label));
}

bool IsosurfaceDistance::Answer::bounds(std::uint32_t label) const {
  return labels.count > 1 && labels.weight_of(label) >= labels.weights[labels.best()] - kSameWeight;
}

IsosurfaceDistance::Answer IsosurfaceDistance::nearest(const Point& p, std::uint32_t& hint) const {
  Nearest nearest;
  if (hint < midpoints_.all().size()) tree_.try_shape(hint, p, nearest);
  tree_.improve(p, nearest);
  hint = nearest.shape;
  return search(p, nearest.point, {});
}

IsosurfaceDistance::Answer IsosurfaceDistance::nearest_of_label(const Point& p, std::uint32_t label) const {
  const auto tree = tree_of_label_.find(label);
  if (tree == tree_of_label_.end()) return {};
  Nearest nearest;
  tree->second.improve(p, nearest);
  return search(p, nearest.point, {true, label});
}

IsosurfaceDistance::Answer IsosurfaceDistance::search(const Point& p, const Point& known,
                                                      const Region& region) const {
  Answer best;
  best.point = known;
  best.squared = squared_distance(p, known);
  Point target;
  if (project(p, p, region, target)) try_segment(p, target, region, best);
  try_segment(p, along(p, known, kOvershoot), region, best);  // on `known` itself there is a tie
  // The isosurface of flat voxels may pass near without a midpoint near: search along each axis.
  for (const Point& step : steps_) {
    const Point neighbor{p[0] + step[0], p[1] + step[1], p[2] + step[2]};
    if (squared_distance(p, neighbor) < kStepSquared * best.squared) try_segment(p, neighbor, region, best);
  }
  for (int i = 0; i < kMaxProjections && project(p, best.point, region, target); ++i)
    if (!try_segment(p, target, region, best)) break;
  best.labels = label_function_.weights_at(frame_.world_to_voxels(best.point));
  return best;
}

// Finds a change between p and `end`, or within the useful part of that segment. Returns false unless it is
// nearer than the best point by more than a thousandth.
bool IsosurfaceDistance::try_segment(const Point& p, const Point& end, const Region& region,
                                     Answer& best) const {
  const double useful = kOvershoot * std::sqrt(best.squared / squared_distance(p, end));
  const Point last = useful < 1 ? along(p, end, useful) : end;
  const Point u = frame_.world_to_voxels(p), v = frame_.world_to_voxels(last);
  const std::uint32_t side = region.side(label_function_.label_at(u));
  if (region.side(label_function_.label_at(v)) == side) return false;
  const double length = std::sqrt(squared_distance(u, v));
  double low = 0, high = 1;
  while ((high - low) * length > kVoxelError) {
    const double middle = 0.5 * (low + high);
    (region.side(label_function_.label_at(along(u, v, middle))) == side ? low : high) = middle;
  }
  const Point change = along(p, last, high);
  const double squared = squared_distance(p, change);
  if (!(squared < best.squared)) return false;
  const bool is_much_nearer = squared < 0.998 * best.squared;
  best.point = change;
  best.squared = squared;
  return is_much_nearer;
}

// Takes the two labels that matter most at `at` and the linear difference of their weights. Sets `target`
// beyond the zero of the difference that is nearest to p, as far again as the zero is.
bool IsosurfaceDistance::project(const Point& p, const Point& at, const Region& region, Point& target) const {
  const Point u = frame_.world_to_voxels(at);
  const LabelWeights weights = label_function_.weights_at(u);
  if (weights.count < 2) return false;
  std::size_t first = weights.best(), second = weights.count;
  for (std::size_t i = 0; region.is_of_label && i < weights.count; ++i)
    if (weights.labels[i] == region.label) first = i;
  for (std::size_t i = 0; i < weights.count; ++i)
    if (i != first && (second == weights.count || weights.weights[i] > weights.weights[second])) second = i;
  const Point g = frame_.gradient_in_world(
      label_function_.gradient_of_difference(u, weights.labels[first], weights.labels[second]));
  const double squared = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
  if (!(squared > 0)) return false;
  const double value = weights.weights[first] - weights.weights[second] + g[0] * (p[0] - at[0]) +
                       g[1] * (p[1] - at[1]) + g[2] * (p[2] - at[2]);
  const double beyond = 2 * value + std::copysign(kWeightOvershoot, value);
  for (std::size_t axis = 0; axis < 3; ++axis) target[axis] = p[axis] - beyond / squared * g[axis];
  return true;
}

}  // namespace podm::verify
