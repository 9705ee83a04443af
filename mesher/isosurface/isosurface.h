// The isosurface oracle: the labels of points, and the nearest points of the object's boundary and
// interfaces.
//
// The label at a point is the one with the greatest trilinear weight among the eight voxels around it. A tie
// goes to the smaller label index. Outside the grid everything is background. The isosurface is the set of
// points where that label changes. Points are in mm, in the working frame.
//
// Lemma. An isosurface point s lies within half a voxel, along every axis, of a surface voxel's center
// (feature_transform.h). Proof: let c be the corner nearest to s of the block that holds s. Let s = c +
// (x,y,z) in units of voxels, with 0 <= x,y,z <= 1/2. Suppose that c is not a surface voxel. Then its three
// neighbors in the block have the same label as c. The weight of these four corners is (1-y)(1-z) +
// (1-x)(y(1-z) + z(1-y)). It does not grow with x, y or z. It is therefore at least its value 1/2 at
// (1/2,1/2,1/2), and exceeds 1/2 elsewhere, where the label of c wins. So s is the block's center, which is
// equally near to all corners, and some corner is a surface voxel.
//
// Where interfaces are smoothed, each voxel has a weight of its own (voxel_weights.h). A block with one
// label still has that label throughout, as all other weights are 0. An isosurface point therefore lies in a
// block with an edge between two labels. The ends of the edge are surface voxels. The point is within *one*
// voxel, along every axis, of their centers. Half a voxel beyond the grid, background still ties, as voxels
// there have the weights of their neighbors inside.
//
// With a flat box (LabelImage::is_box_flat) the label function is that of the image clamped to the outermost
// voxel centers: inside the outer faces of the outermost voxels, the *box*, it is as if these voxels went on.
// Outside the box everything is background. The isosurface then consists of the interfaces in the box and of
// those parts of its sides that have a label. In the outermost half voxel the function does not change along
// the axis, so that the lemma holds there if it holds at the clamped point. Each query branches once: an open
// box takes none of the paths in isosurface_box.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "geometry/affine.h"
#include "geometry/point.h"
#include "isosurface/box_planes.h"
#include "isosurface/feature_transform.h"
#include "isosurface/isosurface_block.h"
#include "isosurface/voxel_weights.h"
#include "podm/label_image.h"

namespace podm {

/// A point of the isosurface that is near to another point.
struct NearPoint {
  Point point;  // accurate to about a hundredth of a voxel
  Voxel surface_voxel;
  bool is_midpoint;  // `point` is where the label changes between two neighboring voxel centers

  /// False for the voxel kNoVoxel: only a side of the box ends the label.
  bool is_on_interface() const { return surface_voxel.i >= 0; }
  static constexpr Voxel kNoVoxel{-1, -1, -1};
};

/// Up to four balls of one radius. A near point in one of them is good enough: the search for a nearer one
/// ends.
struct Cover {
  std::array<const Point*, 4> centers;
  unsigned num_balls = 0;
  double squared_radius = 0;

  bool contains(const Point& z) const {
    return std::any_of(centers.begin(), centers.begin() + num_balls,
                       [&](const Point* c) { return squared_distance(*c, z) < squared_radius; });
  }
};

/// The label at a point, and a lower bound of its distance from the isosurface, mm.
struct LabelAndBound {
  LabelIndex label;
  double bound;
};

/// `Reads` receives every read of the image and of its transform.
template <class Reads>
class Oracle {
 public:
  /// Keeps a reference to `image`. `transform` is the image's; `weights` are its voxel weights, or null if
  /// all are 1.
  Oracle(const LabelImage& image, std::shared_ptr<const FeatureTransform> transform,
         std::shared_ptr<const VoxelWeights> weights, const Reads& reads);
  const LabelImage& image() const { return *image_; }
  const FeatureTransform& transform() const { return *transform_; }
  /// None unless the box is flat.
  const std::optional<BoxPlanes>& box() const { return box_; }

  /// The label of greatest trilinear weight. Away from any label change this is a single look-up.
  LabelIndex label_at(const Point& p) const {
    if (box_) [[unlikely]]
      return label_in_box(p);
    return label_at_voxels(to_voxels(p));
  }

  /// label_at() and distance_lower_bound() of one point, for less than both.
  LabelAndBound label_and_bound(const Point& p, double radius) const {
    if (box_) [[unlikely]]
      return label_and_bound_in_box(p, radius);
    return label_and_bound_of_image(p, radius);
  }

  /// Prefetches the cache lines that the queries about p read first.
  void prefetch(const Point& p) const {
    const Point u = to_voxels(p);
    if (!is_inside(u)) return;
    const Voxel v = nearest_voxel(u);
    features_.prefetch(v);
    grid_.prefetch(v);
  }

  /// A lower bound of the distance from p to the isosurface, mm; 0 if p may lie on it. This is a look-up,
  /// followed by a search only if the search is needed to decide if the distance exceeds `radius`. Inside the
  /// grid the bound exceeds `radius` if the distance exceeds it by two diagonals of a voxel.
  double distance_lower_bound(const Point& p, double radius) const {
    if (box_) [[unlikely]]
      return label_and_bound_in_box(p, radius).bound;
    return bound_of_image(p, radius);
  }

  /// The isosurface point nearest to p, found by local search from the nearest surface voxels, if within
  /// `radius` of p. Among several bumps of voxel size the search may take the second nearest. On smooth
  /// shapes the excess over the nearest distance is typically zero. If no voxel side is much longer than the
  /// others, it exceeds 0.25 of the shortest side in 1 % of cases, and never 1 of it. For voxel sides of 1, 1
  /// and 5 it exceeds 0.55 of the longest side in 1 % of cases, and never 0.75 of it. From far outside the
  /// grid it may be 4 sides. The search may return one of the first points that it finds, if `cover` contains
  /// it.
  std::optional<NearPoint> near_point(const Point& p, double radius, const Cover& cover = {}) const {
    if (box_) [[unlikely]]
      return near_point_in_box(p, radius, cover);
    return near_point_of_image(p, radius, cover);
  }
  /// The near point of p, moved to less than 1e-6 voxel from the isosurface. It may lie slightly beyond
  /// `radius`.
  SurfacePoint polished(const NearPoint& near, const Point& p) const {
    if (box_) [[unlikely]]
      return polished_in_box(near, p);
    return {polished_on_interface(near, p)};
  }

  /// The point where the label changes along segment ab, searched from a; none if there is no change. If the
  /// labels at a and b differ, a point is always returned. Double crossings are found down to 1e-6 of the
  /// segment's part in a block.
  std::optional<SurfacePoint> segment_intersection(const Point& a, const Point& b) const {
    if (box_) [[unlikely]]
      return intersection_in_box(a, b);
    return intersection_of_image(a, b);
  }
  /// With a flat box: the point at which segment ab leaves a label through a side of the box, if just one end
  /// is in the box.
  std::optional<SurfacePoint> exit_through_side(const Point& a, const Point& b) const;
  /// For a point on a side that ends a label: a point of an edge of the box that ends it, too, if one is
  /// within `reach_mm`, otherwise the point itself.
  SurfacePoint moved_onto_edge(const SurfacePoint& z, double reach_mm) const;
  /// The same, or else a point of the curve in which an interface with background meets the side.
  SurfacePoint settled_on_edge(const SurfacePoint& z, double reach_mm) const;
  /// The point of an edge of the box, or of a curve in which an interface meets a side, near
  /// p. `sides` are those of the edge or curve. None if there is no such point within half a voxel.
  std::optional<SurfacePoint> on_curve_of_box(const Point& p, SideMask sides) const;
  /// True if both labels are around a point on sides of the box, in the planes of these sides.
  bool is_between(const SurfacePoint& z, LabelIndex a, LabelIndex b) const;
  /// True if the same search finds a change along ab. The label at both ends must be `label`.
  bool is_crossed(const Point& a, const Point& b, LabelIndex label) const {
    if (box_) [[unlikely]]
      return intersection_in_box(a, b).has_value();
    return is_crossed_in_image(a, b, label);
  }

  /// The queries of an oracle whose box is open, for callers that know this. They do not branch for it.
  class OfOpenBox {
   public:
    explicit OfOpenBox(const Oracle& oracle) : oracle_(oracle) {}
    LabelIndex label_at(const Point& p) const { return oracle_.label_at_voxels(oracle_.to_voxels(p)); }
    LabelAndBound label_and_bound(const Point& p, double radius) const {
      return oracle_.label_and_bound_of_image(p, radius);
    }
    double distance_lower_bound(const Point& p, double radius) const {
      return oracle_.bound_of_image(p, radius);
    }
    std::optional<NearPoint> near_point(const Point& p, double radius, const Cover& cover = {}) const {
      return oracle_.near_point_of_image(p, radius, cover);
    }
    SurfacePoint polished(const NearPoint& near, const Point& p) const {
      return {oracle_.polished_on_interface(near, p)};
    }
    std::optional<SurfacePoint> segment_intersection(const Point& a, const Point& b) const {
      return oracle_.intersection_of_image(a, b);
    }
    bool is_crossed(const Point& a, const Point& b, LabelIndex label) const {
      return oracle_.is_crossed_in_image(a, b, label);
    }

   private:
    const Oracle& oracle_;
  };

 protected:
  const LabelImage* image_;
  std::shared_ptr<const FeatureTransform> transform_;
  std::shared_ptr<const VoxelWeights> weights_;  // null if all weights are 1

 private:
  struct LabelChange {
    double t;  // parameter along the segment
    Voxel block;
    LabelIndex to;
  };

  Point to_voxels(const Point& p) const { return map(to_voxels_, p); }
  Point from_voxels(const Point& u) const { return map(from_voxels_, u); }
  // These two convert directions, which lie along the image's axes.
  Vector to_mm(const Vector& d) const { return {d.x * spacing_.x, d.y * spacing_.y, d.z * spacing_.z}; }
  Vector per_mm(const Vector& gradient) const {
    return {gradient.x * inverse_spacing_.x, gradient.y * inverse_spacing_.y,
            gradient.z * inverse_spacing_.z};
  }
  double length_mm(const Vector& d) const { return std::sqrt(squared_length(to_mm(d))); }

  // All functions below take points in voxels. Bounds and normals are in mm.
  bool is_inside(const Point& u) const {
    const auto is_in = [](double x, double end) {
      return x > -0.5 && x + 0.5 < end + 0.5;
    };  // rounded as in nearest_voxel()
    return is_in(u.x, end_.x) && is_in(u.y, end_.y) && is_in(u.z, end_.z);
  }
  /// `u` must be inside.
  static Voxel nearest_voxel(const Point& u) {
    return {static_cast<int>(u.x + 0.5), static_cast<int>(u.y + 0.5), static_cast<int>(u.z + 0.5)};
  }
  LabelIndex label_at_voxels(const Point& u) const;
  // The next functions ask about u, whose nearest voxel is v, with what is stored of v.
  LabelIndex label_by_feature(const Point& u, const Voxel& v, const StoredFeature& of_v) const;
  /// `v` must be a surface voxel.
  LabelIndex label_by_neighborhood(const Point& u, const Voxel& v, const StoredFeature& of_v) const;
  /// `v` must not be a surface voxel.
  LabelIndex label_off_surface(const Point& u, const Voxel& v, const StoredFeature& of_v) const;
  double bound_by_feature(const Point& u, const Voxel& v, const StoredFeature& of_v, double radius) const;
  LabelIndex label_by_block(const Point& u) const;
  /// Returns ask(weights of the block's corners).
  template <class Ask>
  auto with_weights(const Voxel& block, const Ask& ask) const {
    if (weights_ != nullptr) [[unlikely]]
      return ask(weights_->block(block));
    return ask(UnitWeights{});
  }
  /// The number in [low, high] that is nearest to x, or low if x is not a number.
  static double clamped(double x, double low, double high) { return std::max(low, std::min(x, high)); }
  /// The nearest point of the box of all voxel centers; (0,0,0) for NaN.
  Point clamped_to_grid(const Point& u) const {
    return {clamped(u.x, 0, end_.x - 0.5), clamped(u.y, 0, end_.y - 0.5), clamped(u.z, 0, end_.z - 0.5)};
  }
  // The queries with a flat box (isosurface_box.cpp).
  LabelIndex label_clamped(const Point& p) const { return label_at_voxels(clamped_to_grid(to_voxels(p))); }
  [[gnu::noinline]] LabelIndex label_in_box(const Point& p) const;
  [[gnu::noinline]] LabelAndBound label_and_bound_in_box(const Point& p, double radius) const;
  [[gnu::noinline]] std::optional<NearPoint> near_point_in_box(const Point& p, double radius,
                                                               const Cover& cover) const;
  std::optional<NearPoint> near_interface(const Point& p, double radius, const Cover& cover) const;
  std::optional<SurfacePoint> near_curve(const SurfacePoint& z, double reach_mm) const;
  Point beside_on_side(const SurfacePoint& near, const Point& p) const;
  std::optional<SurfacePoint> intersection_in_box(const Point& a, const Point& b) const;
  std::optional<SurfacePoint> intersection_from_outside(const Point& a, const Point& b) const;
  std::optional<SurfacePoint> change_between(const Point& a, const Point& b) const;
  SurfacePoint polished_in_box(const NearPoint& near, const Point& p) const;
  // The same without a box.
  LabelAndBound label_and_bound_of_image(const Point& p, double radius) const;
  double bound_of_image(const Point& p, double radius) const;
  std::optional<NearPoint> near_point_of_image(const Point& p, double radius, const Cover& cover) const;
  Point polished_on_interface(const NearPoint& near, const Point& p) const;
  std::optional<SurfacePoint> intersection_of_image(const Point& a, const Point& b) const;
  bool is_crossed_in_image(const Point& a, const Point& b, LabelIndex label) const;

  bool is_empty() const { return features_.is_empty(); }
  /// May be negative. Where the transform stores no feature, surface voxels are searched for only if that can
  /// decide if the distance exceeds `radius`.
  double clearance(const Point& u, double radius) const {
    return is_inside(u) ? bound_by_voxel(u, nearest_voxel(u), radius) : bound_from_outside(u, radius);
  }
  double bound_from_outside(const Point& u, double radius) const;
  double bound_by_voxel(const Point& u, const Voxel& v, double radius) const {
    return bound_by_feature(u, v, features_.stored(features_.brick_of(v), v), radius);
  }
  std::optional<LabelChange> first_change(const Point& u, const Vector& d, LabelIndex label) const;
  std::optional<LabelChange> change_in_block(const Point& from, const Vector& d, const Voxel& block,
                                             const BlockLabels& labels, LabelIndex label) const;
  struct Nearest;
  class Sheet;
  double share_to_change(const Voxel& from, unsigned edge) const;
  std::optional<EightVoxels> features_around(const Point& u) const;
  Nearest nearest_midpoint(const EightVoxels& surface_voxels, const Point& u) const;
  bool find_nearer_midpoint(const Point& u, Nearest& best) const;
  // Both are steps of the loop that takes most of a search.
  [[gnu::always_inline]] inline bool pull(Sheet& sheet, Point& z) const;
  [[gnu::always_inline]] inline std::optional<Vector> tangent_step(const Sheet& sheet, const Point& u,
                                                                   const Point& z, double negligible) const;
  double negligible_gain(const Nearest& best) const;
  void descend(Sheet& sheet, const Point& u, Nearest& best) const;
  std::optional<NearPoint> foot(const Nearest& midpoint, const Point& u, double radius) const;

  LabelGrid<Reads> grid_;
  Features<Reads> features_;
  std::optional<BoxPlanes> box_;                // if it is flat
  Affine from_voxels_, to_voxels_;              // to and from the working frame
  Vector spacing_, inverse_spacing_;            // mm per voxel, voxels per mm
  Point end_;                                   // half a voxel beyond the last voxel
  double half_diagonal_mm_, shortest_side_mm_;  // of a voxel
  double to_surface_voxel_mm_;                  // the largest distance from an isosurface point
  double beyond_bricks_mm_;  // the farthest that the isosurface lies outside the bricks with surface voxels
};

/// The oracle without read counts, for most callers.
class Isosurface : public Oracle<NoReads> {
 public:
  /// Runs the feature transform on `threads` threads (0: all cores). Keeps a reference to `image`.
  /// `weights` is null unless the interfaces are smoothed. Throws InputError if the image has more than
  /// 2^31 - 1 voxels.
  Isosurface(const LabelImage& image, int threads, std::shared_ptr<const VoxelWeights> weights = nullptr)
      : Oracle(image, std::make_shared<FeatureTransform>(image, threads), std::move(weights), {}) {}
  /// An oracle with the same results that counts its reads, except those of voxel weights.
  Oracle<CountedReads> counted(const CountedReads& reads) const {
    return {*image_, transform_, weights_, reads};
  }
};

template <class Reads>
inline LabelIndex Oracle<Reads>::label_at_voxels(const Point& u) const {
  // Half a voxel outside the grid, background has at least half the weight.
  if (!is_inside(u)) return kBackground;
  const Voxel v = nearest_voxel(u);
  const Brick brick = features_.brick_of(v);
  // Where all voxels of a brick have one label, that is the label of u unless interfaces are smoothed.
  const bool needs_word = brick.label() == Brick::kMixed || weights_ != nullptr;
  return label_by_feature(u, v, needs_word ? features_.stored(brick, v) : StoredFeature(brick, 0));
}

template <class Reads>
inline LabelIndex Oracle<Reads>::label_by_feature(const Point& u, const Voxel& v,
                                                  const StoredFeature& of_v) const {
  if (of_v.is_surface()) return label_by_neighborhood(u, v, of_v);
  if (weights_ != nullptr) [[unlikely]]
    return label_off_surface(u, v, of_v);
  // The lemma leaves one case in which u has another label than v, a voxel off the surface: a tie at the
  // block's center.
  constexpr double kNotCenter = 1.5 - 1e-9;
  const Vector offset = u - center(v);
  if (std::fabs(offset.x) + std::fabs(offset.y) + std::fabs(offset.z) > kNotCenter) {
    return label_by_block(u);
  }
  return of_v.brick().label() == Brick::kMixed ? grid_.label_inside(v) : of_v.brick().label();
}

}  // namespace podm
