// The isosurface point nearest to a point u. Start: the midpoint of two neighbouring voxels of different
// labels is on the isosurface; take the nearest one. Then project u on the tangent plane there, and there
// again, until it stays; a shot from u finds where exactly the label changes. Where that is no nearer
// (creases, several labels), shots from u along the normals at the nearest point so far try to improve it.
#include <algorithm>
#include <limits>

#include "image/isosurface.h"

namespace podm {

struct Isosurface::Nearest {
  Point u;
  double squared_mm = std::numeric_limits<double>::infinity();
  Voxel block;       // that holds u
  LabelIndex other;  // that the label changes to
};

namespace {

constexpr int kMaxProjections = 10;
constexpr int kUndampedProjections = 3;  // later ones go half way: on a crease they would swing for ever
constexpr double kSettled = 0.01;        // voxel sides; the distance is settled to about the square of it
constexpr double kOvershoot = 1.01;
constexpr int kMaxImprovements = 5;
constexpr double kImproved = 1 - 1e-3;  // of the squared distance

constexpr double kAside = 0.01;  // voxels
constexpr double kIrregular = 1e4;

constexpr double square(double x) { return x * x; }

// The edges between the 64 corners of a block and its neighbours, by their first corner.
constexpr std::uint64_t kEdgesX = 0x7777'7777'7777'7777;
constexpr std::uint64_t kEdgesY = 0x0fff'0fff'0fff'0fff;
constexpr std::uint64_t kEdgesZ = 0x0000'ffff'ffff'ffff;

}  // namespace

// Scans the edges of a block and of its 26 neighbours.
void Isosurface::try_midpoints_around(const Voxel& block, const Point& u, LabelIndex label,
                                      Nearest& best) const {
  const std::uint64_t others = grid_.corners_of_other_label(block, label);
  if (others == 0) return;
  const Point origin = center(block) - Vector{1, 1, 1};
  std::array<std::array<double, 4>, 3> corner2, middle2;  // squared mm from u along each axis
  for (std::size_t i = 0; i < 4; ++i) {
    const double at = static_cast<double>(i);
    const Vector to_corner = to_mm(u - origin - Vector{at, at, at});
    const Vector to_middle = to_corner - 0.5 * spacing_;
    for (std::size_t a = 0; a < 3; ++a) {
      corner2[a][i] = square(coordinate(to_corner, a));
      middle2[a][i] = square(coordinate(to_middle, a));
    }
  }
  std::size_t nearest = 64;
  Vector nearest_step;
  const auto scan = [&](std::uint64_t edges, const Vector& step, const auto& x2, const auto& y2,
                        const auto& z2) {
    for (; edges != 0; edges &= edges - 1) {
      const auto e = static_cast<std::size_t>(std::countr_zero(edges));
      const double squared = x2[e & 3] + y2[e >> 2 & 3] + z2[e >> 4];
      if (squared >= best.squared_mm) continue;
      best.squared_mm = squared;
      nearest = e;
      nearest_step = step;
    }
  };
  scan((others ^ others >> 1) & kEdgesX, {1, 0, 0}, middle2[0], corner2[1], corner2[2]);
  scan((others ^ others >> 4) & kEdgesY, {0, 1, 0}, corner2[0], middle2[1], corner2[2]);
  scan((others ^ others >> 16) & kEdgesZ, {0, 0, 1}, corner2[0], corner2[1], middle2[2]);
  if (nearest == 64) return;
  const Point first = origin + Vector{static_cast<double>(nearest & 3), static_cast<double>(nearest >> 2 & 3),
                                      static_cast<double>(nearest >> 4)};
  const Point beyond = (others >> nearest & 1) != 0 ? first : first + nearest_step;
  best.u = first + 0.5 * nearest_step;
  best.block = block_of(first);
  best.other = grid_.label(block_of(beyond));
}

// Scans the edges of the features of the voxels around u, the nearest voxel's first: it rules most others
// out.
void Isosurface::try_midpoints_of_features(const Point& u, LabelIndex label, Nearest& best) const {
  const Voxel block = block_of(clamped_to_grid(u));
  auto last = features_.nearest(grid_.index(nearest_voxel(clamped_to_grid(u))));
  try_midpoints_of(last, u, label, best);
  for (int c = 0; c < 8; ++c) {
    const Point corner = center({block.i + (c & 1), block.j + (c >> 1 & 1), block.k + (c >> 2)});
    const auto feature = features_.nearest(grid_.index(nearest_voxel(clamped_to_grid(corner))));
    if (feature == last) continue;
    last = feature;
    try_midpoints_of(feature, u, label, best);
  }
}

// Midpoints lie half a side from the feature, so one that is too far has none to offer.
void Isosurface::try_midpoints_of(FeatureTransform::VoxelIndex index, const Point& u, LabelIndex label,
                                  Nearest& best) const {
  const Voxel feature = grid_.voxel(index);
  const double excess_mm = length_mm(center(feature) - u) - 0.5 * longest_side_mm_;
  if (excess_mm > 0 && square(excess_mm) >= best.squared_mm) return;
  const LabelIndex own = grid_.label(index);
  for (const Voxel& step :
       {Voxel{-1, 0, 0}, Voxel{1, 0, 0}, Voxel{0, -1, 0}, Voxel{0, 1, 0}, Voxel{0, 0, -1}, Voxel{0, 0, 1}}) {
    const Point middle = center(feature) + 0.5 * center(step);
    const double squared = squared_length(to_mm(middle - u));
    if (squared >= best.squared_mm) continue;
    const Voxel neighbor{feature.i + step.i, feature.j + step.j, feature.k + step.k};
    const LabelIndex other = grid_.label(neighbor);
    if (other != own) best = {middle, squared, block_of(middle), own == label ? other : own};
  }
}

// The nearest, or one that no other within a block's reach of it beats.
Isosurface::Nearest Isosurface::nearest_midpoint(const Point& u, LabelIndex label) const {
  Nearest nearest;
  if (is_inside(u)) try_midpoints_around(block_of(u), u, label, nearest);
  if (nearest.squared_mm > square(shortest_side_mm_)) {
    try_midpoints_of_features(u, label, nearest);
    for (double before = 0; before != nearest.squared_mm;) {
      before = nearest.squared_mm;
      try_midpoints_around(block_of(nearest.u), u, label, nearest);
    }
  }
  return nearest;
}

// Moves z to the foot of u on the isosurface; false where it has no normal.
bool Isosurface::project(const Point& u, LabelIndex label, Point& z) const {
  Voxel block;
  std::optional<Trilinear> lead;
  Point last = z;
  for (int i = 0; i < kMaxProjections; ++i) {
    if (const Voxel b = block_of(z); !lead || b != block) {
      const BlockLabels labels = grid_.block(b);
      const CornerMask mask = labels.mask(label), others = ~mask & kAllCorners;
      if (mask == 0 || others == 0) {  // beyond the end of the interface
        z = 0.5 * (z + last);
        continue;
      }
      block = b;
      lead = weight_difference(mask, labels.mask(labels.first(others)));
    }
    const Point f = z - center(block);
    const Vector gradient = lead->gradient(f), normal = per_mm(per_mm(gradient));  // a voxel; voxels a mm^2
    const double length2 = dot(gradient, normal);
    if (length2 == 0) return false;
    // Stationary: u - z = multiplier * normal. The rest of u - z lies in the tangent plane; a step along it
    // is right on a plane, and shortened where the isosurface bends away.
    const double multiplier = dot(gradient, u - z) / length2;
    const Vector tangent = u - z - multiplier * normal;
    const double tangent2 = squared_length(to_mm(tangent));
    const double bend = multiplier * lead->second_derivative(f, tangent);
    double part = tangent2 / std::max(tangent2 + bend, 0.5 * tangent2);
    if (!(part <= 2)) part = 0;
    if (i >= kUndampedProjections) part *= 0.5;
    const Vector step = part * tangent - (lead->value(f) / length2) * normal;
    last = z;
    z = z + step;
    if (squared_length(to_mm(step)) < square(kSettled * shortest_side_mm_)) break;
  }
  return true;
}

// Whether the label changes along u + t d, t in [0,1], clearly nearer to u than at `best`, which is updated.
bool Isosurface::shoot(const Point& u, const Vector& d, LabelIndex label, Nearest& best) const {
  const auto change = first_change(u, d, label);
  if (!change) return false;
  const Point z = u + change->t * d;
  const double squared = squared_length(to_mm(z - u));
  if (squared >= best.squared_mm) return false;
  const bool is_clearly_nearer = squared < kImproved * best.squared_mm;
  best = {z, squared, change->block, change->to};
  return is_clearly_nearer;
}

// Shoots as far as the best so far, against the normal there, or else half-way between.
void Isosurface::improve(const Point& u, LabelIndex label, Nearest& best) const {
  for (int i = 0; i < kMaxImprovements && best.squared_mm > 0; ++i) {
    const BlockLabels labels = grid_.block(best.block);
    const Vector normal = per_mm(
        weight_difference(labels.mask(label), labels.mask(best.other)).gradient(best.u - center(best.block)));
    if (squared_length(normal) == 0) return;
    const auto reach = [&](const Vector& mm) {
      return to_voxels(std::sqrt(best.squared_mm / squared_length(mm)) * mm);
    };
    const Vector against = reach(-1.0 * normal);
    if (shoot(u, against, label, best)) continue;
    const Vector between = to_mm(against + (best.u - u));
    if (squared_length(between) == 0 || !shoot(u, reach(between), label, best)) return;
  }
}

// Midpoints lie on a lattice, and vertices of a lattice make flat cells that rounding can turn inside out.
// Where the nearest point is a midpoint, take a point of the isosurface a little beside it, as irregular as u
// itself.
Point Isosurface::beside_midpoint(const Point& u, LabelIndex label, const Point& midpoint) const {
  const Vector aside =
      kAside * Vector{std::sin(kIrregular * u.x), std::sin(kIrregular * u.y), std::sin(kIrregular * u.z)};
  const Vector d = kOvershoot * (midpoint + aside - u);
  const auto change = first_change(u, d, label);
  return to_mm(change ? u + change->t * d : midpoint);
}

std::optional<Point> Isosurface::closest_point(const Point& p, double radius) const {
  if (is_empty()) return std::nullopt;
  const Point u = to_voxels(p);
  const LabelIndex label = label_at_voxels(u);
  Nearest best = nearest_midpoint(u, label);
  Point z = best.u;
  const Point midpoint = best.u;
  if (!project(u, label, z) || !shoot(u, kOvershoot * (z - u), label, best)) improve(u, label, best);
  if (!(best.squared_mm <= square(radius))) return std::nullopt;
  if (best.u == midpoint) {
    const Point beside = beside_midpoint(u, label, midpoint);
    if (squared_distance(beside, p) <= square(radius)) return beside;
  }
  return to_mm(best.u);
}

}  // namespace podm
