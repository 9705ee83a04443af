// The isosurface point nearest to a point u. Start: the midpoint of two neighbouring voxels of different
// labels is on the isosurface; take the nearest one among the features of the voxels around u. Then descend:
// step along the tangent plane towards the foot of u, pull the result back to the isosurface, and keep it if
// it is nearer to u, otherwise try a shorter step.
#include <algorithm>
#include <limits>
#include <utility>

#include "image/isosurface.h"

namespace podm {

namespace {

constexpr int kMaxSteps = 8;          // tried, taken or not
constexpr double kShorter = 0.35;     // what is left of a step that leads no nearer
constexpr double kNegligible = 0.01;  // voxel sides: twice the least gain in distance of a step
constexpr double kTowards = 1e-3;     // a share of the way to u
constexpr int kPullsToStep = 1, kMaxPulls = 8;
constexpr double kOnIsosurface = 1e-7;  // voxels
constexpr double kAside = 0.01;         // voxels
constexpr double kIrregular = 1e4;

constexpr double square(double x) { return x * x; }

// Two labels meet where the weights of their corners of the block balance: one function for each choice of
// corners.
constexpr auto kBalances = []<std::size_t... mask>(std::index_sequence<mask...>) {
  return std::array{weight_difference(mask, ~mask & kAllCorners)...};
}
(std::make_index_sequence<kAllCorners + 1>());

}  // namespace

// The function that vanishes on the isosurface around a point: the weight of the label of a surface voxel
// less the greatest weight of another label.
template <class Reads>
class Oracle<Reads>::Sheet {
 public:
  Sheet(const Oracle& oracle, const Voxel& surface_voxel)
      : oracle_(oracle),
        center_(surface_voxel),
        around_(oracle.features_.neighborhood(oracle.grid_.index(surface_voxel))) {}

  /// Goes to the sheet at u; false if no isosurface passes through its block, or none around u's nearest
  /// voxel.
  bool move_to(const Point& u) {
    const Voxel block = block_of(u);
    if (!is_beside_center(block) && !recenter(u)) return false;
    const CornerMask others =
        around_.differing_corners(block.i - center_.i, block.j - center_.j, block.k - center_.k);
    if (others == 0) return false;
    origin_ = podm::center(block);
    at_ = u - origin_;
    if (around_.has_two_labels()) {
      lead_ = &kBalances[others];
    } else {
      own_lead_ = lead_of_many(block, others);
      lead_ = &*own_lead_;
    }
    return true;
  }
  const Voxel& center() const { return center_; }
  double value() const { return lead_->value(at_); }
  Vector gradient() const { return lead_->gradient(at_); }
  double second_derivative(const Vector& d) const { return lead_->second_derivative(at_, d); }

 private:
  bool is_beside_center(const Voxel& block) const {
    const auto is_beside = [](int b, int c) { return static_cast<unsigned>(c - b) <= 1; };
    return is_beside(block.i, center_.i) && is_beside(block.j, center_.j) && is_beside(block.k, center_.k);
  }
  bool recenter(const Point& u) {
    if (!oracle_.is_inside(u)) return false;
    const Voxel nearest = nearest_voxel(u);
    const std::size_t index = oracle_.grid_.index(nearest);
    const std::optional<Neighborhood> around = oracle_.features_.neighborhood_if_surface(index);
    if (!around) return false;
    center_ = nearest;
    around_ = *around;
    return true;
  }
  Trilinear lead_of_many(const Voxel& block, CornerMask others) const {
    const BlockLabels labels = oracle_.grid_.block(block);
    CornerMask strongest = 0;
    double greatest = -1;
    for (CornerMask rest = others; rest != 0;) {
      const CornerMask corners = labels.mask(labels.first(rest));
      rest &= ~corners;
      const double w = weight(corners, at_);
      if (w > greatest) {
        greatest = w;
        strongest = corners;
      }
    }
    return weight_difference(strongest, ~others & kAllCorners);
  }

  const Oracle& oracle_;
  Voxel center_;
  Neighborhood around_;
  Point origin_{};
  Vector at_{};
  const Trilinear* lead_ = nullptr;
  std::optional<Trilinear> own_lead_;
};

// The squared distance from u, which lies -d mm from a surface voxel, to the nearest midpoint between it and
// a 6-neighbour of another label.
template <class Reads>
double Oracle<Reads>::squared_distance_to_midpoint(Neighborhood around, const Vector& d) const {
  constexpr std::array<unsigned, 3> kStep{1, 3, 9};
  constexpr unsigned kCenter = Neighborhood::position(0, 0, 0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    const double along = coordinate(d, a), side = coordinate(spacing_, a);
    const unsigned towards_u = along > 0 ? kCenter - kStep[a] : kCenter + kStep[a];
    const double quarter = 0.25 * side * side, reach = std::fabs(along) * side;
    if (around.differs(towards_u)) {
      least = std::min(least, quarter - reach);
    } else if (around.differs(2 * kCenter - towards_u)) {
      least = std::min(least, quarter + reach);
    }
  }
  return squared_length(d) + least;
}

// The feature of a voxel around u that has the nearest midpoint beside it. All look-ups are asked for before
// the first is needed.
template <class Reads>
Voxel Oracle<Reads>::feature_near(const Point& u) const {
  const Point inside = clamped_to_grid(u);
  const Voxel low = block_of(inside);
  const Voxel high{std::min(low.i + 1, grid_.num_x() - 1), std::min(low.j + 1, grid_.num_y() - 1),
                   std::min(low.k + 1, grid_.num_z() - 1)};
  std::array<typename Features<Reads>::VoxelIndex, 8> features;
  for (unsigned c = 0; c < 8; ++c) {
    features[c] = features_.nearest(
        grid_.index({c & 1 ? high.i : low.i, c & 2 ? high.j : low.j, c & 4 ? high.k : low.k}));
    features_.prefetch(features[c]);
  }
  std::array<Voxel, 8> voxels;
  std::array<double, 8> squared;
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 8; ++c) {
    voxels[c] = grid_.voxel(features[c]);
    squared[c] = squared_length(to_mm(center(voxels[c]) - u));
    least2 = std::min(least2, squared[c]);
  }
  // Midpoints lie at most half a side from the feature: none that is two halves farther than the nearest
  // counts.
  const double too_far2 = square(std::sqrt(least2) + longest_side_mm_);
  std::size_t best = 0;
  double best2 = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 8; ++c) {
    if (squared[c] > too_far2 || (c > 0 && features[c] == features[c - 1])) continue;
    const double midpoint2 =
        squared_distance_to_midpoint(features_.neighborhood(features[c]), to_mm(center(voxels[c]) - u));
    if (midpoint2 >= best2) continue;
    best = c;
    best2 = midpoint2;
  }
  return voxels[best];
}

template <class Reads>
struct Oracle<Reads>::Nearest {
  Voxel surface_voxel;  // beside u
  Point u{};
  double squared_mm = std::numeric_limits<double>::infinity();
};

// Takes the nearest midpoint of the 54 edges of the 27 voxels around the surface voxel of `best`, if it is
// nearer.
template <class Reads>
bool Oracle<Reads>::try_midpoints_around(const Point& u, Nearest& best) const {
  struct Position {
    std::uint8_t i, j, k;
  };
  static constexpr auto kPositions = [] {
    std::array<Position, 27> positions{};
    for (std::uint8_t e = 0; e < 27; ++e)
      positions[e] = {static_cast<std::uint8_t>(e % 3), static_cast<std::uint8_t>(e / 3 % 3),
                      static_cast<std::uint8_t>(e / 9)};
    return positions;
  }();
  const Voxel middle = best.surface_voxel;
  const Vector d = to_mm(center(middle) - u);
  // Squared mm from u along each axis, of the voxels and of the midpoints between them.
  std::array<std::array<double, 3>, 3> voxel2, midpoint2;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double to_voxel = coordinate(d, a) + (static_cast<double>(i) - 1) * coordinate(spacing_, a);
      voxel2[a][i] = square(to_voxel);
      midpoint2[a][i] = square(to_voxel + 0.5 * coordinate(spacing_, a));
    }
  }
  const Neighborhood around = features_.neighborhood(grid_.index(middle));
  double nearest2 = best.squared_mm * (1 - 1e-12);
  unsigned nearest = 27, nearest_axis = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto &x2 = axis == 0 ? midpoint2[0] : voxel2[0], &y2 = axis == 1 ? midpoint2[1] : voxel2[1],
               &z2 = axis == 2 ? midpoint2[2] : voxel2[2];
    for (std::uint32_t edges = around.differing_edges(axis); edges != 0; edges &= edges - 1) {
      const auto e = static_cast<unsigned>(std::countr_zero(edges));
      const double squared = x2[kPositions[e].i] + y2[kPositions[e].j] + z2[kPositions[e].k];
      if (squared >= nearest2) continue;
      nearest2 = squared;
      nearest = e;
      nearest_axis = axis;
    }
  }
  if (nearest == 27) return false;
  const Position at = kPositions[nearest];
  const Voxel first{middle.i - 1 + at.i, middle.j - 1 + at.j, middle.k - 1 + at.k};
  const Voxel step{nearest_axis == 0, nearest_axis == 1, nearest_axis == 2};
  const Voxel second{first.i + step.i, first.j + step.j, first.k + step.k};
  best = {grid_.contains(first) ? first : second, center(first) + 0.5 * center(step), nearest2};
  return true;
}

// Moves z along the gradient until the sheet's value says that it is on the isosurface, to `tolerance`
// voxels.
template <class Reads>
bool Oracle<Reads>::pull(Sheet& sheet, Point& z, int max_pulls) const {
  for (int i = 0; i < max_pulls; ++i) {
    if (!sheet.move_to(z)) return false;
    const Vector gradient = sheet.gradient(), normal = per_mm(per_mm(gradient));
    const double length2 = dot(gradient, normal), value = sheet.value();
    if (length2 == 0) return false;
    z = z - (value / length2) * normal;
    if (square(value) < square(kOnIsosurface) * squared_length(gradient)) return sheet.move_to(z);
  }
  return max_pulls == kPullsToStep && sheet.move_to(z);
}

// The step along the tangent plane at z towards the foot of u. A midpoint lies on an edge of four blocks: the
// one that holds the way to u counts.
template <class Reads>
std::optional<Vector> Oracle<Reads>::tangent_step(Sheet& sheet, const Point& u, const Point& z) const {
  if (!sheet.move_to(z + kTowards * (u - z)) && !sheet.move_to(z)) return std::nullopt;
  const Vector gradient = sheet.gradient(), normal = per_mm(per_mm(gradient));  // a voxel; voxels a mm^2
  const double length2 = dot(gradient, normal);
  if (length2 == 0) return std::nullopt;
  // Stationary: u - z = multiplier * normal. The rest of u - z lies in the tangent plane; a step along it is
  // right on a plane, and shortened where the isosurface bends away.
  const double multiplier = dot(gradient, u - z) / length2;
  const Vector tangent = u - z - multiplier * normal;
  const double tangent2 = squared_length(to_mm(tangent));
  const double bend = multiplier * sheet.second_derivative(tangent);
  double part = tangent2 / std::max(tangent2 + bend, 0.5 * tangent2);
  if (!(part <= 2)) part = 1;
  return part * tangent;
}

// Moves best.u along the isosurface to the foot of u, as long as a step brings it noticeably nearer.
template <class Reads>
void Oracle<Reads>::descend(Sheet& sheet, const Point& u, Nearest& best) const {
  std::optional<Vector> step = tangent_step(sheet, u, best.u);
  for (int i = 0; step && i < kMaxSteps; ++i) {
    // The least gain in squared distance for which a step is taken.
    const double negligible = kNegligible * shortest_side_mm_ * std::sqrt(best.squared_mm);
    if (squared_length(to_mm(*step)) < negligible) return;
    Point z = best.u + *step;
    const bool is_on_isosurface = pull(sheet, z, kPullsToStep);
    const double squared = squared_length(to_mm(z - u));
    if (is_on_isosurface && squared < best.squared_mm - 0.1 * negligible) {
      best.u = z;
      best.squared_mm = squared;
      step = tangent_step(sheet, u, z);
    } else {
      step = kShorter * *step;
    }
  }
}

template <class Reads>
std::optional<NearPoint> Oracle<Reads>::near_point(const Point& p, double radius) const {
  if (is_empty()) return std::nullopt;
  const Point u = to_voxels(p);
  Nearest best{feature_near(u)};
  while (try_midpoints_around(u, best)) {
  }
  const Point midpoint = best.u;
  Sheet sheet(*this, best.surface_voxel);
  descend(sheet, u, best);
  if (!(best.squared_mm <= square(radius))) return std::nullopt;
  return NearPoint{from_voxels(best.u), sheet.center(), best.u == midpoint};
}

// Midpoints lie on a lattice, and vertices of a lattice make flat cells that rounding can turn inside out:
// take a point of the isosurface a little beside it, as irregular as p itself.
template <class Reads>
Point Oracle<Reads>::polished(const NearPoint& near, const Point& p) const {
  const Point u = to_voxels(p);
  Point z = to_voxels(near.point);
  if (near.is_midpoint) {
    const Vector irregular{std::sin(kIrregular * u.x), std::sin(kIrregular * u.y),
                           std::sin(kIrregular * u.z)};
    z = z + kAside * irregular;
  }
  Sheet sheet(*this, near.surface_voxel);
  if (pull(sheet, z, kMaxPulls)) return from_voxels(z);
  Nearest midpoint{near.surface_voxel};
  try_midpoints_around(u, midpoint);
  return from_voxels(midpoint.u);
}

template std::optional<NearPoint> Oracle<NoReads>::near_point(const Point&, double) const;
template std::optional<NearPoint> Oracle<CountedReads>::near_point(const Point&, double) const;
template Point Oracle<NoReads>::polished(const NearPoint&, const Point&) const;
template Point Oracle<CountedReads>::polished(const NearPoint&, const Point&) const;

}  // namespace podm
