#include "isosurface/box_planes.h"

#include <cmath>
#include <limits>

#include "image/working_frame.h"

namespace podm {

namespace {

constexpr std::array<double Point::*, 3> kCoordinates{&Point::x, &Point::y, &Point::z};

constexpr SideMask bit(std::size_t side) { return static_cast<SideMask>(1u << side); }

}  // namespace

BoxPlanes::BoxPlanes(const LabelImage& image) {
  const Affine a = voxels_to_working(image);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double step = a[4 * row + axis];
      if (step == 0) continue;
      const double first = step * -0.5 + a[4 * row + 3],
                   last = step * (image.size[axis] - 0.5) + a[4 * row + 3];
      axes_[row] = {std::min(first, last), std::max(first, last), std::fabs(step), bit(2 * axis + (step < 0)),
                    bit(2 * axis + (step > 0))};
    }
}

bool BoxPlanes::contains(const Point& p) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (!(axes_[a].low <= p.*kCoordinates[a] && p.*kCoordinates[a] <= axes_[a].high)) return false;
  return true;
}

SurfacePoint BoxPlanes::moved_onto_sides(const Point& p, double voxels) const {
  SurfacePoint moved{p};
  for (std::size_t a = 0; a < 3; ++a) {
    const Axis& axis = axes_[a];
    double& at = moved.*kCoordinates[a];
    if (at <= axis.low + voxels * axis.voxel_mm) {
      at = axis.low;
      moved.sides |= axis.low_side;
    } else if (at >= axis.high - voxels * axis.voxel_mm) {
      at = axis.high;
      moved.sides |= axis.high_side;
    }
  }
  return moved;
}

SurfacePoint BoxPlanes::onto_planes(const SurfacePoint& z, double voxels, double reach_mm) const {
  struct Plane {
    double away, at;
    std::size_t axis;
    SideMask side;
  };
  std::array<Plane, 3> nearest;
  for (std::size_t a = 0; a < 3; ++a) {
    const Axis& axis = axes_[a];
    const double to_low = z.*kCoordinates[a] - axis.low, to_high = axis.high - z.*kCoordinates[a];
    nearest[a] = to_low < to_high ? Plane{to_low, axis.low, a, axis.low_side}
                                  : Plane{to_high, axis.high, a, axis.high_side};
  }
  std::ranges::sort(nearest, {}, &Plane::away);
  SurfacePoint moved = z;
  double left = reach_mm * reach_mm;
  for (const Plane& plane : nearest) {
    if (plane.away * plane.away > left || plane.away > voxels * axes_[plane.axis].voxel_mm) continue;
    left -= plane.away * plane.away;
    moved.*kCoordinates[plane.axis] = plane.at;
    moved.sides |= plane.side;
  }
  return moved;
}

Point BoxPlanes::moved_onto(SideMask sides, const Point& z) const {
  Point moved = z;
  for (std::size_t a = 0; a < 3; ++a) {
    if ((sides & axes_[a].low_side) != 0) moved.*kCoordinates[a] = axes_[a].low;
    if ((sides & axes_[a].high_side) != 0) moved.*kCoordinates[a] = axes_[a].high;
  }
  return moved;
}

SurfacePoint BoxPlanes::nearest_on_side(const Point& p) const {
  double least = std::numeric_limits<double>::infinity();
  SurfacePoint nearest{p};
  const auto take = [&](std::size_t a, double plane, SideMask side) {
    const double away = std::fabs(p.*kCoordinates[a] - plane);
    if (away >= least) return;
    least = away;
    nearest = {p, side};
    nearest.*kCoordinates[a] = plane;
  };
  for (std::size_t a = 0; a < 3; ++a) {
    take(a, axes_[a].low, axes_[a].low_side);
    take(a, axes_[a].high, axes_[a].high_side);
  }
  return nearest;
}

std::optional<Point> BoxPlanes::middle_inside(const Point& a, const Point& b) const {
  double begin = 0, end = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double from = a.*kCoordinates[i], step = b.*kCoordinates[i] - from;
    const double low = axes_[i].low - from, high = axes_[i].high - from;
    if (step == 0 && (low > 0 || high < 0)) return std::nullopt;
    if (step == 0) continue;
    begin = std::max(begin, std::min(low / step, high / step));
    end = std::min(end, std::max(low / step, high / step));
  }
  const Point middle = a + 0.5 * (begin + end) * (b - a);
  return begin < end && contains(middle) ? std::optional(middle) : std::nullopt;
}

SurfacePoint BoxPlanes::exit(const Point& inside, const Point& outside) const {
  double least = 1;
  SideMask side = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double from = inside.*kCoordinates[a], to = outside.*kCoordinates[a];
    if (to >= axes_[a].low && to <= axes_[a].high) continue;
    const bool is_low = to < axes_[a].low;
    const double t = ((is_low ? axes_[a].low : axes_[a].high) - from) / (to - from);
    if (t > least) continue;
    least = t;
    side = is_low ? axes_[a].low_side : axes_[a].high_side;
  }
  const Point at = moved_onto(side, inside + least * (outside - inside));
  const SurfacePoint in_box = clamped(at);
  return {in_box, static_cast<SideMask>(in_box.sides | side)};
}

}  // namespace podm
