#include "refine/rules.h"

#include <algorithm>
#include <cmath>
#include <concepts>

#include "podm/bounds.h"
#include "refine/near_lines.h"

namespace podm {

namespace {

constexpr double square(double x) { return x * x; }
// The nearest point that the oracle finds is the true one, up to a small error.
constexpr double kNearestTrust = 0.9;
// R3's point on a side moves to an edge of the box, or to a curve, within this share of its ball's radius.
constexpr double kToEdge = 0.7;
// Any point of R3 moves to a side that is near enough to be a sample of it, within this share.
constexpr double kToSide = 0.5;
// So does R1's point, within this share of delta.
constexpr double kToEdgeOfDelta = 0.3;
constexpr double kSquaredRatio = square(kRadiusEdgeBound * (1 - kMargin));

Point clamped(const Point& p, const Box& box) {
  return {std::clamp(p.x, box.low.x, box.high.x), std::clamp(p.y, box.low.y, box.high.y),
          std::clamp(p.z, box.low.z, box.high.z)};
}

}  // namespace

template <class Cells>
RulesOn<Cells>::RulesOn(Cells& mesh, const Isosurface& isosurface, const Parameters& parameters,
                        const std::optional<CountedReads>& reads)
    : mesh_(mesh),
      isosurface_(isosurface),
      parameters_(parameters),
      squared_delta_(square(parameters.delta_mm)),
      squared_two_delta_(square(2 * parameters.delta_mm)),
      has_deltas_(parameters.deltas != nullptr),
      has_box_(isosurface.box().has_value()),
      has_box_or_counts_(has_box_ || reads),
      untested_(has_box_ ? Facets::kUntestedInBox : Facets::kUntested) {
  if (reads) counted_.emplace(isosurface.counted(*reads));
}

// Several workers may look up the label of the same neighbor at once. Relaxed: all of them write the same
// value.
template <class Cells>
LabelIndex RulesOn<Cells>::look_up_label(CellId c) const {
  const LabelIndex label = ask([&](const auto& oracle) { return oracle.label_at(mesh_.cell(c).center); });
  store(mesh_.label(c), label, std::memory_order_relaxed);
  return label;
}

// Both for the circumcenter of the cell.
template <class Cells>
LabelAndBound RulesOn<Cells>::label_and_bound(CellId c, double radius) const {
  const Point& center = mesh_.cell(c).center;
  const LabelIndex known = load(mesh_.label(c), std::memory_order_relaxed);
  if (known != kUnknownLabel) return {known, distance_lower_bound(center, radius)};
  const LabelAndBound found = ask([&](const auto& oracle) { return oracle.label_and_bound(center, radius); });
  store(mesh_.label(c), found.label, std::memory_order_relaxed);
  return found;
}

template <class Cells>
double RulesOn<Cells>::distance_lower_bound(const Point& p, double radius) const {
  return ask([&](const auto& oracle) { return oracle.distance_lower_bound(p, radius); });
}

template <class Cells>
double RulesOn<Cells>::squared_delta_at(const Point& p) const {
  return square(parameters_.deltas->at(p));
}

template <class Cells>
double RulesOn<Cells>::squared_delta_at_either(const Point& p, const Point& q) const {
  return std::min(squared_delta_at(p), squared_delta_at(q));
}

template <class Cells>
double RulesOn<Cells>::least_squared_delta(const Point& center, double radius) const {
  const DeltaField& deltas = *parameters_.deltas;
  return square(deltas.least_within(radius, deltas.at(center)));
}

template <class Cells>
bool RulesOn<Cells>::is_covered_by_any(const Cell& cell, const Point& z) const {
  return std::any_of(cell.vertices.begin(), cell.vertices.end(),
                     [&](VertexId v) { return is_covered(z, v); });
}

// If r < delta/2, an isosurface vertex of the cell is within 2r < delta of z. R1 then does not apply, nor
// does R2.
template <class Cells>
bool RulesOn<Cells>::obeys_r1_and_r2(const Cell& cell, double squared_radius, double squared_delta) const {
  return 4 * squared_radius < squared_delta &&
         std::any_of(cell.vertices.begin(), cell.vertices.end(),
                     [&](VertexId v) { return is_on_isosurface(mesh_.vertex(v).kind); });
}

template <class Cells>
Examination RulesOn<Cells>::examine(CellId c) const {
  const Cell& cell = mesh_.cell(c);
  const Point& center = cell.center;
  const double squared_radius = squared_distance(center, mesh_.point(cell.vertices[3]));
  const double radius = std::sqrt(squared_radius);
  const auto [label, bound] = label_and_bound(c, radius);
  Examination t;
  t.cell = c;
  t.center = center;
  t.squared_radius = squared_radius;
  t.label = label;
  t.isosurface_distance = bound;
  if (t.isosurface_distance > radius) return t;
  const double squared_delta = has_deltas_ ? least_squared_delta(center, radius) : squared_delta_;
  if (obeys_r1_and_r2(cell, squared_radius, squared_delta)) return t;
  const Cover cover = covered_by(cell, squared_delta);
  t.nearest = ask([&](const auto& oracle) { return oracle.near_point(center, radius, cover); });
  t.is_covered = t.nearest && (cover.contains(t.nearest->point) ||
                               (has_deltas_ && is_covered_by_any(cell, t.nearest->point)));
  t.is_distance_proven = false;
  t.isosurface_distance = kNearestTrust * (t.nearest ? distance(center, t.nearest->point) : radius);
  return t;
}

// The balls around the cell's own isosurface vertices.
template <class Cells>
Cover RulesOn<Cells>::covered_by(const Cell& cell, double squared_delta) const {
  Cover cover;
  cover.squared_radius = squared_delta;
  for (const VertexId v : cell.vertices) {
    if (is_on_isosurface(mesh_.vertex(v).kind)) cover.centers[cover.num_balls++] = &mesh_.point(v);
  }
  return cover;
}

template <class Cells>
bool RulesOn<Cells>::is_covered(const Point& z, VertexId by) const {
  if (!is_on_isosurface(mesh_.vertex(by).kind)) return false;
  const double squared = squared_distance(mesh_.point(by), z);
  return squared < squared_delta_ && (!has_deltas_ || squared < squared_delta_at(z));
}

template <class Cells>
std::optional<SurfacePoint> RulesOn<Cells>::r1_sample(const Examination& t) const {
  if (!t.relies_on_others()) return std::nullopt;
  SurfacePoint z = ask([&](const auto& oracle) { return oracle.polished(*t.nearest, t.center); });
  if (has_box_) [[unlikely]]
    z = moved_to_sides(z, kToEdgeOfDelta * parameters_.delta_mm);
  return is_covered_beside(t.cell, z) ? std::nullopt : std::optional(z);
}

template <class Cells>
std::optional<SurfacePoint> RulesOn<Cells>::settled(const Point& p, double radius_mm) const {
  const auto near = ask([&](const auto& oracle) { return oracle.near_point(p, radius_mm); });
  if (!near) return std::nullopt;
  return std::optional(ask([&](const auto& oracle) { return oracle.polished(*near, p); }));
}

template <class Cells>
std::optional<SurfacePoint> RulesOn<Cells>::settled_on_sides(const SurfacePoint& p, double radius_mm) const {
  if (p.sides == 0) return settled(p, radius_mm);
  return ask_either([&](const auto& oracle) { return oracle.on_curve_of_box(p, p.sides); });
}

template <class Cells>
SurfacePoint RulesOn<Cells>::near_sides(const SurfacePoint& z, double radius_mm) const {
  return has_box_ ? moved_to_sides(z, kToSide * radius_mm) : z;
}

// True if a vertex opposite to one of the cell's facets covers z. The caller would find this vertex, or one
// nearer to z, among the cavity's vertices, but at the cost of the cavity.
template <class Cells>
bool RulesOn<Cells>::is_covered_beside(CellId c, const Point& z) const {
  const auto& mirrors = mesh_.cell(c).mirrors;
  return std::any_of(mirrors.begin(), mirrors.end(), [&](FacetId mirror) {
    return mirror != kNoFacet &&
           is_covered(z, mesh_.cell(cell_of(mirror)).vertices[static_cast<unsigned>(index_in_cell(mirror))]);
  });
}

template <class Cells>
std::optional<Point> RulesOn<Cells>::r2_center(const Examination& t) const {
  if (!t.nearest) return std::nullopt;
  if (t.squared_radius >= squared_two_delta_) return clamped(t.center, parameters_.clamp_box);
  return has_deltas_ ? r2_center_by_place(t) : std::nullopt;
}

template <class Cells>
std::optional<Point> RulesOn<Cells>::r2_center_by_place(const Examination& t) const {
  if (t.squared_radius < 4 * squared_delta_at_either(t.center, t.nearest->point)) return std::nullopt;
  return clamped(t.center, parameters_.clamp_box);
}

// Returns true if a vertex is off the isosurface or an angle is at most 30 degrees: a side is then at most as
// long as the facet's circumradius (side = 2 R sin(opposite angle)). Near lines the circumradius must be as
// long as kNearLinesRatio sides.
template <class Cells>
bool RulesOn<Cells>::needs_sample(CellId c, unsigned facet) const {
  const auto& vertices = mesh_.cell(c).vertices;
  std::array<const Point*, 3> p{};
  for (unsigned i = 0; i < 3; ++i) {
    const Vertex& v = mesh_.vertex(vertices[static_cast<unsigned>(kFacetVertices[facet][i])]);
    if (!is_on_isosurface(v.kind)) return true;
    p[i] = &v.point;
  }
  const Vector ab = *p[1] - *p[0], ac = *p[2] - *p[0], bc = *p[2] - *p[1];
  const double a2 = squared_length(bc), b2 = squared_length(ac), c2 = squared_length(ab);
  // R^2 = a2 b2 c2 / (4 |ab x ac|^2)
  const double of_sides = std::min({a2, b2, c2}) * 4 * squared_length(cross(ab, ac)),
               of_radius = a2 * b2 * c2 * (1 + kMargin);
  if (of_sides > of_radius) return false;
  return kNearLinesRatio * kNearLinesRatio * of_sides <= of_radius || !is_near_lines(mesh_, vertices, facet);
}

// Returns true if the facet's dual edge may meet the isosurface, which needs an edge longer than the distance
// to the isosurface. Where that distance is not proven, labels that differ also show it.
template <class Cells>
bool RulesOn<Cells>::may_be_restricted(const Examination& t, CellId neighbor) const {
  if (square(t.isosurface_distance) < squared_distance(t.center, mesh_.cell(neighbor).center)) return true;
  return !t.is_distance_proven && label_of(neighbor) != t.label;
}

// Returns true if the isosurface meets the facet's dual edge. The part of the edge in a ball that is proven
// to contain no isosurface point need not be searched.
template <class Cells>
bool RulesOn<Cells>::is_restricted(const Examination& t, CellId neighbor) const {
  if (label_of(neighbor) != t.label) return true;
  const Point& end = mesh_.cell(neighbor).center;
  const double clear = t.is_distance_proven ? t.isosurface_distance / distance(t.center, end) : 0;
  const Point start = t.center + clear * (end - t.center);
  return ask([&](const auto& oracle) { return oracle.is_crossed(start, end, t.label); });
}

// R3 tests the facet itself, its two cells and the image: both cells come to one answer. Cells that an
// operation plans have facets that were never tested.
template <class Cells>
FacetMask RulesOn<Cells>::facets_tested_before(CellId c) const {
  if constexpr (std::same_as<Cells, Mesh>) {
    FacetMask tested = mesh_.facets_passing_r3(c);
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = mesh_.cell(c).mirrors[k];
      if (mirror != kNoFacet)
        tested |= (mesh_.facets_passing_r3(cell_of(mirror)) >> index_in_cell(mirror) & 1) << k;
    }
    return tested;
  }
  return 0;
}

// An open box pays no branch if facets are untested, which is in all of refinement.
template <class Cells>
FacetSearch RulesOn<Cells>::search_facets(const Examination& t, Facets facets) const {
  FacetMask tested = 0;
  if (facets == Facets::kUntested)
    tested = facets_tested_before(t.cell);
  else if (has_box_) [[unlikely]]
    return search_in_box(t, facets == Facets::kUntestedInBox ? facets_tested_before(t.cell) : 0);
  return search<false>(t, tested);
}

template <class Cells>
template <bool kInBox>
FacetSearch RulesOn<Cells>::search(const Examination& t, FacetMask tested) const {
  FacetSearch search{.center = {}, .passing = 0};
  for (unsigned k = 0; k < 4; ++k) {
    const FacetId mirror = mesh_.cell(t.cell).mirrors[k];
    if (mirror == kNoFacet || (tested >> k & 1) != 0) continue;
    const CellId neighbor = cell_of(mirror);
    const bool may_be = may_be_restricted(t, neighbor);
    // The other cell may find otherwise if it has a distance that is proven, or another that is not.
    if (!may_be && !t.is_distance_proven) continue;
    if constexpr (kInBox) {
      if (may_be) search.center = center_in_box(t, neighbor, k);
    } else if (may_be && needs_sample(t.cell, k) && is_restricted(t, neighbor)) {
      search.center = surface_center(t, neighbor);
    }
    if (search.center) return search;
    search.passing |= 1u << k;
  }
  return search;
}

template <class Cells>
std::optional<SurfaceCenter> RulesOn<Cells>::center_in_box(const Examination& t, CellId neighbor,
                                                           unsigned facet) const {
  if (const auto on_side = center_on_side(t, neighbor, facet)) return on_side;
  const bool needs = needs_sample(t.cell, facet);
  if (!needs && !has_foreign_sample(t, neighbor, facet)) return std::nullopt;
  if (!is_restricted(t, neighbor)) return std::nullopt;
  const std::optional<SurfacePoint> z = change_on_dual_edge(t, neighbor);
  if (!z || (!needs && reach_at(*z, 1, t.cell, facet) < parameters_.lines->floor_mm())) return std::nullopt;
  const SurfacePoint moved = moved_to_sides(*z, reach_at(*z, kToSide, t.cell, facet));
  if (const auto found = in_conflict(moved, t.cell, neighbor)) return found;
  return in_conflict(*z, t.cell, neighbor);
}

// True if the facet is between two labels that do not meet at a sample of it on a side.
template <class Cells>
bool RulesOn<Cells>::has_foreign_sample(const Examination& t, CellId neighbor, unsigned facet) const {
  if (parameters_.lines == nullptr || t.label == kBackground) return false;
  const LabelIndex other = label_of(neighbor);
  if (other == kBackground || other == t.label) return false;
  const auto& vertices = mesh_.cell(t.cell).vertices;
  return std::ranges::any_of(kFacetVertices[facet], [&](int i) {
    const Vertex& v = mesh_.vertex(vertices[static_cast<unsigned>(i)]);
    if (v.kind != VertexKind::kIsosurface || v.sides == 0) return false;
    const SurfacePoint z{v.point, v.sides};
    return !ask_either([&](const auto& oracle) { return oracle.is_between(z, t.label, other); });
  });
}

template <class Cells>
std::optional<SurfaceCenter> RulesOn<Cells>::surface_center(const Examination& t, CellId neighbor) const {
  const std::optional<SurfacePoint> z = change_on_dual_edge(t, neighbor);
  return z ? in_conflict(*z, t.cell, neighbor) : std::nullopt;
}

// The search goes from the lexicographically smaller center to the larger one: both cells of the facet find
// the same point.
template <class Cells>
std::optional<SurfacePoint> RulesOn<Cells>::change_on_dual_edge(const Examination& t, CellId neighbor) const {
  const Point *from = &t.center, *to = &mesh_.cell(neighbor).center;
  if (lexicographically_less(*to, *from)) std::swap(from, to);
  return ask([&](const auto& oracle) { return oracle.segment_intersection(*from, *to); });
}

template <class Cells>
std::optional<SurfaceCenter> RulesOn<Cells>::in_conflict(const SurfacePoint& z, CellId c,
                                                         CellId neighbor) const {
  for (const CellId start : {c, neighbor}) {
    if (mesh_.is_in_conflict(start, z)) return SurfaceCenter{z, start};
  }
  return std::nullopt;
}

// The point at which the dual edge leaves a label through a side of the box, unless all vertices of the facet
// are on that side.
template <class Cells>
std::optional<SurfaceCenter> RulesOn<Cells>::center_on_side(const Examination& t, CellId neighbor,
                                                            unsigned facet) const {
  const std::optional<SurfacePoint> z = ask_either(
      [&](const auto& oracle) { return oracle.exit_through_side(t.center, mesh_.cell(neighbor).center); });
  if (!z || (z->sides & common_sides(t.cell, facet)) != 0) return std::nullopt;
  const double reach = reach_at(*z, kToEdge, t.cell, facet);
  const SurfacePoint settled =
      ask_either([&](const auto& oracle) { return oracle.settled_on_edge(*z, reach); });
  if (const auto found = in_conflict(settled, t.cell, neighbor)) return found;
  return in_conflict(*z, t.cell, neighbor);
}

// Moves a point of the isosurface onto sides that are very near, and from a side onto an edge of the box, by
// at most `reach` in all. Both moves are along axes.
template <class Cells>
SurfacePoint RulesOn<Cells>::moved_to_sides(const SurfacePoint& z, double reach) const {
  const SurfacePoint snapped = isosurface_.box()->snapped(z, reach);
  if (snapped.sides == 0) return z;
  const double left = std::sqrt(std::max(square(reach) - squared_distance(z, snapped), 0.0));
  return ask_either([&](const auto& oracle) { return oracle.moved_onto_edge(snapped, left); });
}

// The ball around z, on the dual edge of the facet, through the facet's vertices is empty. A point may move
// by this share of its radius, and stays above the floor of the spacing.
template <class Cells>
double RulesOn<Cells>::reach_at(const Point& z, double share, CellId c, unsigned facet) const {
  const auto first = static_cast<unsigned>(kFacetVertices[facet][0]);
  return share * distance(z, mesh_.point(mesh_.cell(c).vertices[first]));
}

template <class Cells>
SideMask RulesOn<Cells>::common_sides(CellId c, unsigned facet) const {
  unsigned common = ~0u;
  for (const int i : kFacetVertices[facet])
    common &= mesh_.vertex(mesh_.cell(c).vertices[static_cast<unsigned>(i)]).sides;
  return static_cast<SideMask>(common);
}

template <class Cells>
auto RulesOn<Cells>::first_crossing(const Point& from, const Point& to) const -> std::optional<Crossing> {
  constexpr double kBeyond = 1e-6;  // of the way
  const std::optional<SurfacePoint> z =
      ask([&](const auto& oracle) { return oracle.segment_intersection(from, to); });
  if (!z) return std::nullopt;
  return Crossing{*z, ask([&](const auto& oracle) { return oracle.label_at(*z + kBeyond * (to - from)); })};
}

template <class Cells>
bool RulesOn<Cells>::has_poor_ratio(CellId c, double squared_radius) const {
  const auto& v = mesh_.cell(c).vertices;
  for (const auto& edge : kEdgeVertices) {
    const double l2 = squared_distance(mesh_.point(v[static_cast<unsigned>(edge[0])]),
                                       mesh_.point(v[static_cast<unsigned>(edge[1])]));
    if (squared_radius >= kSquaredRatio * l2) return true;
  }
  return false;
}

template <class Cells>
bool RulesOn<Cells>::is_large(double squared_radius, LabelIndex label, const Point& center) const {
  const SizeField& sizes = parameters_.sizes;
  if (squared_radius > sizes.squared_radius_of_label(label) * (1 - kMargin)) return true;
  return sizes.has_grid() && squared_radius > sizes.smallest_squared_radius() * (1 - kGridMargin) &&
         squared_radius > sizes.squared_radius_of_grid(center) * (1 - kGridMargin);
}

template <class Cells>
std::optional<Rule> RulesOn<Cells>::volume_rule(const Examination& t) const {
  if (t.label == kBackground) return is_large_in_shell(t) ? std::optional(Rule::kR5) : std::nullopt;
  if (has_poor_ratio(t.cell, t.squared_radius)) return Rule::kR4;
  if (is_large(t.squared_radius, t.label, t.center)) return Rule::kR5;
  return std::nullopt;
}

template <class Cells>
bool RulesOn<Cells>::is_sound(CellId c) const {
  const Examination t = examine(c);
  return !r1_sample(t) && !r2_center(t) && !r3_surface_center(t) && !volume_rule(t);
}

template <class Cells>
bool RulesOn<Cells>::is_large_in_shell(const Examination& t) const {
  if (parameters_.shell_mm == 0) return false;
  double share = 1;
  if (parameters_.sizes.has_grid())
    share = std::min(
        1.0, std::sqrt(parameters_.sizes.squared_radius_of_grid(t.center)) / parameters_.shell_radius_mm);
  const double reach_mm = share * parameters_.shell_mm;
  return t.squared_radius > square(share * parameters_.shell_radius_mm) &&
         is_in(parameters_.clamp_box, t.center) && distance_lower_bound(t.center, reach_mm) < reach_mm;
}

// With a grid, or with deltas by place, the smaller of the bounds at both points counts. Otherwise samples
// where cells are large would remove vertices inserted where cells are small, again and again. Outside the
// object the grid's bound may be below the smallest bound inside, which then applies.
template <class Cells>
bool RulesOn<Cells>::r6_removes(VertexId v, const Point& z) const {
  if (mesh_.vertex(v).kind != VertexKind::kCircumcenter) return false;
  const SizeField& sizes = parameters_.sizes;
  const Point& p = mesh_.point(v);
  const double squared = squared_distance(p, z);
  if (squared >= squared_two_delta_) return false;
  if (has_deltas_ && squared >= 4 * squared_delta_at_either(p, z)) return false;
  return !sizes.has_grid() || squared < sizes.smallest_squared_radius() ||
         (squared < sizes.squared_radius_of_grid(z) && squared < sizes.squared_radius_of_grid(p));
}

template class RulesOn<Mesh>;
template class RulesOn<VertexMove>;

}  // namespace podm
