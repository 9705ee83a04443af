// The queries with a flat box, whose sides end the object. In the box they rest on those of the image clamped
// to the outermost voxel centers, whose isosurface consists of the interfaces alone.
//
// If a point of the box is background, its nearest isosurface point is on an interface: the way to any point
// of a side with a label crosses one. If it has a label, a side is as near as its plane, unless the
// projection onto the plane is background. Then the way there crosses an interface, which is nearer.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "isosurface/isosurface.h"

namespace podm {

namespace {

// Rounding may make the distance to a plane too large. This factor makes it a lower bound.
constexpr double kBelowRounding = 1 - 1e-12;
constexpr double kAsideOnSide = 0.01;  // voxels
constexpr double kIrregularOnSide = 1e4;

}  // namespace

template <class Reads>
LabelIndex Oracle<Reads>::label_in_box(const Point& p) const {
  return box_->contains(p) ? label_clamped(p) : kBackground;
}

template <class Reads>
LabelAndBound Oracle<Reads>::label_and_bound_in_box(const Point& p, double radius) const {
  const bool is_in_box = box_->contains(p);
  const Point inside = is_in_box ? p : Point(box_->clamped(p));
  const LabelIndex label = label_clamped(inside);
  const double to_box = kBelowRounding * distance(p, inside);
  if (!is_in_box && label != kBackground) return {kBackground, to_box};
  const double to_interface = std::max(clearance(to_voxels(inside), radius), 0.0);
  if (!is_in_box) return {kBackground, kBelowRounding * std::hypot(to_box, to_interface)};
  if (label == kBackground) return {label, to_interface};
  return {label, std::min(to_interface, kBelowRounding * distance(p, box_->nearest_on_side(p)))};
}

// A point that is found outside moves into the box, and may then lie beyond `radius`.
template <class Reads>
std::optional<NearPoint> Oracle<Reads>::near_interface(const Point& p, double radius,
                                                       const Cover& cover) const {
  std::optional<NearPoint> near = near_point_of_image(p, radius, cover);
  if (!near) return near;
  near->point = box_->snapped(near->point);
  return near;
}

template <class Reads>
std::optional<NearPoint> Oracle<Reads>::near_point_in_box(const Point& p, double radius,
                                                          const Cover& cover) const {
  const auto on_side = [&](const SurfacePoint& z) {
    return NearPoint{box_->snapped(z), NearPoint::kNoVoxel, false};
  };
  if (!box_->contains(p)) {
    const SurfacePoint inside = box_->clamped(p);
    if (squared_distance(p, inside) > radius * radius) return std::nullopt;
    if (label_clamped(inside) != kBackground) return on_side(inside);
    const std::optional<NearPoint> near = near_interface(p, radius, cover);
    return near && squared_distance(p, near->point) <= radius * radius ? near : std::nullopt;
  }
  if (label_clamped(p) == kBackground) return near_interface(p, radius, cover);
  const SurfacePoint z = box_->nearest_on_side(p);
  const double to_side = distance(p, z);
  if (to_side > radius || label_clamped(z) == kBackground) return near_interface(p, radius, cover);
  if (cover.contains(z)) return on_side(z);
  const std::optional<NearPoint> near = near_interface(p, to_side, cover);
  return near && squared_distance(p, near->point) < to_side * to_side ? near : on_side(z);
}

// A point that lies on sides stays on them.
template <class Reads>
SurfacePoint Oracle<Reads>::polished_in_box(const NearPoint& near, const Point& p) const {
  const SideMask sides = box_->snapped(near.point).sides;
  if (!near.is_on_interface()) return {beside_on_side({near.point, sides}, p), sides};
  const SurfacePoint z = box_->snapped(polished_on_interface(near, p));
  return {box_->moved_onto(sides, z), static_cast<SideMask>(z.sides | sides)};
}

// Moves a point of a side slightly along it, as irregularly as p, if it then still has a label. The first
// points that the rules ask about are regular, and four vertices of a side on one circle make a flat cell.
template <class Reads>
Point Oracle<Reads>::beside_on_side(const SurfacePoint& near, const Point& p) const {
  const Point u = to_voxels(p);
  const Vector irregular{std::sin(kIrregularOnSide * u.x), std::sin(kIrregularOnSide * u.y),
                         std::sin(kIrregularOnSide * u.z)};
  const Point z = box_->moved_onto(near.sides, from_voxels(to_voxels(near) + kAsideOnSide * irregular));
  const bool stays = box_->snapped(z).sides == near.sides && label_clamped(z) != kBackground;
  return stays ? z : near;
}

template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::exit_through_side(const Point& a, const Point& b) const {
  const bool is_a_inside = box_->contains(a);
  if (is_a_inside == box_->contains(b)) return std::nullopt;
  const SurfacePoint z = is_a_inside ? box_->exit(a, b) : box_->exit(b, a);
  return label_clamped(z) != kBackground ? std::optional(z) : std::nullopt;
}

template <class Reads>
SurfacePoint Oracle<Reads>::moved_onto_edge(const SurfacePoint& z, double reach_mm) const {
  const SurfacePoint moved = box_->onto_planes(z, reach_mm);
  return label_clamped(moved) != kBackground ? moved : z;
}

// The search for a curve leads to all interfaces. Beyond one that ends the object is background.
template <class Reads>
SurfacePoint Oracle<Reads>::settled_on_edge(const SurfacePoint& z, double reach_mm) const {
  constexpr double kBeyond = 1.02;
  const SurfacePoint on_edge = moved_onto_edge(z, reach_mm);
  if (on_edge.sides != z.sides) return on_edge;
  const std::optional<SurfacePoint> on_curve = near_curve(z, reach_mm);
  if (!on_curve) return z;
  const bool ends_object = label_clamped(z + kBeyond * (*on_curve - z)) == kBackground;
  return ends_object && squared_distance(z, *on_curve) < reach_mm * reach_mm ? *on_curve : z;
}

// The point nearest to z of all interfaces, on the sides of z.
template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::near_curve(const SurfacePoint& z, double reach_mm) const {
  const std::optional<NearPoint> near = near_interface(z, reach_mm, {});
  if (!near || (box_->snapped(near->point).sides & z.sides) != z.sides) return std::nullopt;
  return polished(*near, z);
}

template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::on_curve_of_box(const Point& p, SideMask sides) const {
  const SurfacePoint z{box_->moved_onto(sides, p), sides};
  if (std::popcount(sides) == 1) return near_curve(z, 0.5 * shortest_side_mm_);
  return label_clamped(z) != kBackground ? std::optional(z) : std::nullopt;
}

template <class Reads>
bool Oracle<Reads>::is_between(const SurfacePoint& z, LabelIndex a, LabelIndex b) const {
  constexpr int kDirections = 12;
  constexpr double kBeside = 1e-3;  // voxels
  const Point u = to_voxels(z);
  bool has_a = false, has_b = false;
  for (int i = 0; i < kDirections && !(has_a && has_b); ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    const double x = kBeside * std::cos(angle), y = kBeside * std::sin(angle);
    for (const Vector& beside : {Vector{x, y, 0}, Vector{y, 0, x}, Vector{0, x, y}}) {
      const LabelIndex label = label_clamped(box_->moved_onto(z.sides, from_voxels(u + beside)));
      has_a = has_a || label == a;
      has_b = has_b || label == b;
    }
  }
  return has_a && has_b;
}

template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::intersection_in_box(const Point& a, const Point& b) const {
  if (!box_->contains(a)) return intersection_from_outside(a, b);
  const bool is_b_inside = box_->contains(b);
  const SurfacePoint end = is_b_inside ? SurfacePoint{b} : box_->exit(a, b);
  if (const auto change = change_between(a, end)) return change;
  const LabelIndex at_b = is_b_inside ? label_clamped(b) : kBackground;
  if (label_clamped(a) == at_b) return std::nullopt;
  return end;
}

// A segment between two points outside may pass through the box.
template <class Reads>
std::optional<SurfacePoint> Oracle<Reads>::intersection_from_outside(const Point& a, const Point& b) const {
  const std::optional<Point> inside = box_->contains(b) ? std::optional(b) : box_->middle_inside(a, b);
  if (!inside) return std::nullopt;
  const SurfacePoint entry = box_->exit(*inside, a);
  if (label_clamped(entry) != kBackground) return entry;
  return intersection_in_box(entry, b);
}

#define PODM_INSTANTIATE(Reads)                                                                            \
  template LabelIndex Oracle<Reads>::label_in_box(const Point&) const;                                     \
  template LabelAndBound Oracle<Reads>::label_and_bound_in_box(const Point&, double) const;                \
  template std::optional<NearPoint> Oracle<Reads>::near_point_in_box(const Point&, double, const Cover&)   \
      const;                                                                                               \
  template SurfacePoint Oracle<Reads>::polished_in_box(const NearPoint&, const Point&) const;              \
  template std::optional<SurfacePoint> Oracle<Reads>::exit_through_side(const Point&, const Point&) const; \
  template SurfacePoint Oracle<Reads>::moved_onto_edge(const SurfacePoint&, double) const;                 \
  template SurfacePoint Oracle<Reads>::settled_on_edge(const SurfacePoint&, double) const;                 \
  template std::optional<SurfacePoint> Oracle<Reads>::on_curve_of_box(const Point&, SideMask) const;       \
  template bool Oracle<Reads>::is_between(const SurfacePoint&, LabelIndex, LabelIndex) const;              \
  template std::optional<SurfacePoint> Oracle<Reads>::intersection_in_box(const Point&, const Point&) const;
PODM_INSTANTIATE(NoReads)
PODM_INSTANTIATE(CountedReads)
#undef PODM_INSTANTIATE

}  // namespace podm
