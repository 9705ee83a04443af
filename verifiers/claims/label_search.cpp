#include "claims/label_search.h"

#include <array>
#include <cmath>

namespace podm::verify {

namespace {

constexpr int kProbes = 4;                // per segment, each a quarter as far as the one before
constexpr double kNearEnough = 1 / 64.0;  // relative to the reach: no further direction is tried
constexpr double kBisected = 1 / 64.0;    // relative to the distance found

Point at(const Point& u, const Point& direction, double t) {
  return {u[0] + t * direction[0], u[1] + t * direction[1], u[2] + t * direction[2]};
}

double length(const Point& d) { return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]); }

// The directions to the faces, edges and corners of a cube.
std::array<Point, 26> unit_directions() {
  std::array<Point, 26> directions{};
  std::size_t i = 0;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const double scale = 1 / std::sqrt(x * x + y * y + z * z);
        directions[i++] = {scale * x, scale * y, scale * z};
      }
  return directions;
}

}  // namespace

LabelSearch::Rivals LabelSearch::rivals(const Point& u, const Wanted& wanted) const {
  const LabelWeights weights = function_.weights_at(u);
  Rivals rivals;
  rivals.is_alone = weights.count == 1;
  for (std::size_t i = 0; i < weights.count; ++i) {
    std::optional<std::uint32_t>& label = wanted(weights.labels[i]) ? rivals.wanted : rivals.other;
    double& weight = wanted(weights.labels[i]) ? rivals.wanted_weight : rivals.other_weight;
    if (label && weights.weights[i] <= weight) continue;
    label = weights.labels[i];
    weight = weights.weights[i];
  }
  return rivals;
}

// A weight changes by at most 1 per voxel along each axis, and therefore by at most sqrt(3) per voxel. A
// label that is alone has weight 1; in a smoothed image this is no such weight.
bool LabelSearch::is_out_of_reach(const Rivals& rivals, double reach) {
  const double slopes = 2 * std::sqrt(3.0);
  return !rivals.is_alone && rivals.other_weight - rivals.wanted_weight >
                                 1.001 * slopes * reach + 4 * LabelFunction::kWeightError;
}

// The label at u must not be wanted.
std::optional<LabelSearch::Found> LabelSearch::along(const Point& u, const Point& direction,
                                                     const Wanted& wanted, double reach,
                                                     std::uint64_t& num_exact) const {
  double high = reach;
  std::optional<Found> found;
  const auto probe = [&](double t) {
    const Point p = at(u, direction, t);
    const std::uint32_t label = label_at(p, num_exact);
    if (wanted(label)) found = Found{p, label, t};
    return wanted(label);
  };
  for (int i = 0; i < kProbes && !found; ++i)
    if (!probe(high)) high /= 4;
  if (!found) return found;
  double low = 0;
  while (high - low > kBisected * high && high > 1e-12) {
    const double middle = 0.5 * (low + high);
    (probe(middle) ? high : low) = middle;
  }
  return found;
}

std::optional<LabelSearch::Found> LabelSearch::find(const Point& u, const Wanted& wanted, double reach,
                                                    std::uint64_t& num_exact) const {
  const Rivals rivals = this->rivals(u, wanted);
  if (is_out_of_reach(rivals, reach) && !function_.is_at_side(u, reach)) return std::nullopt;
  std::optional<Found> best;
  const auto try_direction = [&](const Point& direction) {
    const auto found = along(u, direction, wanted, best ? best->distance : reach, num_exact);
    if (found && (!best || found->distance < best->distance)) best = found;
  };
  if (rivals.wanted && rivals.other) {
    const Point gradient = function_.gradient_of_difference(u, *rivals.wanted, *rivals.other);
    if (const double slope = length(gradient); slope > 0)
      try_direction({gradient[0] / slope, gradient[1] / slope, gradient[2] / slope});
  }
  if (best && best->distance < kNearEnough * reach) return best;
  static const std::array<Point, 26> kDirections = unit_directions();
  for (const Point& direction : kDirections) try_direction(direction);
  return best;
}

}  // namespace podm::verify
