// Follows a segment from block to block to the point where the label changes.
#include <algorithm>
#include <limits>

#include "isosurface/isosurface.h"
#include "isosurface/isosurface_cubic.h"

namespace podm {

namespace {

// The blocks that the line u + t d passes, in order (Amanatides, Woo, Eurographics '87).
class BlockWalk {
 public:
  BlockWalk(const Point& u, const Vector& d) : u_{u.x, u.y, u.z}, d_{d.x, d.y, d.z} {
    for (std::size_t a = 0; a < 3; ++a) inverse_[a] = d_[a] == 0 ? 0 : 1 / d_[a];
  }

  void start_at(double t) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double position = u_[a] + t * d_[a], floor = std::floor(position);
      block_[a] = static_cast<int>(floor) - (d_[a] < 0 && position == floor);
      next_[a] = exit(a);
    }
  }
  void step() {
    const std::size_t a =
        next_[0] <= next_[1] ? (next_[0] <= next_[2] ? 0 : 2) : (next_[1] <= next_[2] ? 1 : 2);
    block_[a] += d_[a] > 0 ? 1 : -1;
    next_[a] = exit(a);
  }
  Voxel block() const { return {block_[0], block_[1], block_[2]}; }
  double exit() const { return std::min({next_[0], next_[1], next_[2]}); }

 private:
  double exit(std::size_t a) const {
    if (d_[a] == 0) return std::numeric_limits<double>::infinity();
    return (block_[a] + (d_[a] > 0) - u_[a]) * inverse_[a];
  }

  std::array<double, 3> u_, d_, inverse_, next_;
  std::array<int, 3> block_;
};

// Narrows [begin,end] to the part of u + t d within [low,high]. Returns false if nothing is left.
bool clip(double u, double d, double low, double high, double& begin, double& end) {
  if (u >= low && u <= high && u + d >= low && u + d <= high) return true;
  if (d == 0) return false;
  const double t0 = (low - u) / d, t1 = (high - u) / d;
  begin = std::max(begin, std::min(t0, t1));
  end = std::min(end, std::max(t0, t1));
  return begin <= end;
}

constexpr int kBlocksBetweenJumps = 3;
constexpr double kAnyBound = -std::numeric_limits<double>::infinity();

}  // namespace

template <class Reads>
auto Oracle<Reads>::change_in_block(const Point& from, const Vector& d, const Voxel& block,
                                    const BlockLabels& labels, LabelIndex label) const
    -> std::optional<LabelChange> {
  std::optional<LabelChange> first;
  const CornerMask mask = labels.mask(label);
  for (CornerMask rest = ~mask & kAllCorners; rest != 0;) {
    const LabelIndex other = labels.first(rest);
    const CornerMask others = labels.mask(other);
    rest &= ~others;
    const auto lead = with_weights(block, [&](const auto& weights) {
      return weight_difference(mask, others, weights).along(from - center(block), d);
    });
    const std::optional<double> s = first_fall(lead, label < other);
    if (s && (!first || *s < first->t)) first = LabelChange{*s, block, other};
  }
  return first;
}

// The first point of u + t d, with t in [0,1], where `label`, the label at u, no longer wins.
template <class Reads>
auto Oracle<Reads>::first_change(const Point& u, const Vector& d, LabelIndex label) const
    -> std::optional<LabelChange> {
  double t = 0, t_end = 1;
  if (!clip(u.x, d.x, -1, grid_.num_x(), t, t_end) || !clip(u.y, d.y, -1, grid_.num_y(), t, t_end) ||
      !clip(u.z, d.z, -1, grid_.num_z(), t, t_end)) {
    return std::nullopt;
  }
  BlockWalk walk(u, d);
  walk.start_at(t);
  int blocks_to_jump = kBlocksBetweenJumps;
  while (true) {
    const BlockLabels labels = grid_.block(walk.block());
    const double exit = std::clamp(walk.exit(), t, t_end);
    if (!labels.is_uniform(label)) {
      if (auto change = change_in_block(u + t * d, (exit - t) * d, walk.block(), labels, label)) {
        change->t = t + change->t * (exit - t);
        return change;
      }
      blocks_to_jump = kBlocksBetweenJumps;
    } else if (blocks_to_jump-- == 0) {
      const double jump = clearance(u + t * d, kAnyBound) / length_mm(d);
      blocks_to_jump = kBlocksBetweenJumps;
      if (t + jump > exit) {
        t += jump;
        if (t >= t_end) return std::nullopt;
        walk.start_at(t);
        blocks_to_jump = 0;
        continue;
      }
    }
    t = exit;
    if (t >= t_end) return std::nullopt;
    walk.step();
  }
}

template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::intersection_of_image(const Point& a, const Point& b) const {
  const Point u = to_voxels(a), v = to_voxels(b);
  const LabelIndex label = label_at_voxels(u);
  if (const auto change = first_change(u, v - u, label)) return SurfacePoint{a + change->t * (b - a)};
  if (label_at_voxels(v) == label) return std::nullopt;
  return SurfacePoint{b};  // the change is so close to b that rounding hides it from first_change()
}

template <class Reads>
bool Oracle<Reads>::is_crossed_in_image(const Point& a, const Point& b, LabelIndex label) const {
  const Point u = to_voxels(a);
  return first_change(u, to_voxels(b) - u, label).has_value();
}

// The first change of the label between two points of the box.
template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::change_between(const Point& a, const Point& b) const {
  const Point u = to_voxels(a);
  if (const auto change = first_change(u, to_voxels(b) - u, label_clamped(a)))
    return SurfacePoint{a + change->t * (b - a)};
  return std::nullopt;
}

template std::optional<SurfacePoint> Oracle<NoReads>::intersection_of_image(const Point&, const Point&) const;
template std::optional<SurfacePoint> Oracle<CountedReads>::intersection_of_image(const Point&,
                                                                                 const Point&) const;
template std::optional<SurfacePoint> Oracle<NoReads>::change_between(const Point&, const Point&) const;
template std::optional<SurfacePoint> Oracle<CountedReads>::change_between(const Point&, const Point&) const;
template bool Oracle<NoReads>::is_crossed_in_image(const Point&, const Point&, LabelIndex) const;
template bool Oracle<CountedReads>::is_crossed_in_image(const Point&, const Point&, LabelIndex) const;

}  // namespace podm
