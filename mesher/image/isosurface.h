// The isosurface oracle: what the object's boundary is, and where its nearest point lies.
//
// The label at a point is the one with the greatest trilinear weight among the eight voxels around it, ties
// to the smaller label index; outside the grid everything is background. The isosurface is the set of points
// where that label changes. All coordinates are mm in the image frame (podm/label_image.h).
//
// Lemma. An isosurface point s lies within half a voxel, along every axis, of a surface voxel's centre
// (feature_transform.h). Proof: let c be the corner nearest to s of the block that holds s, s = c + (x,y,z)
// in units of voxels with 0 <= x,y,z <= 1/2. If c is no surface voxel, it has its label in common with its
// three neighbours in the block, and that label's weight, (1-y)(1-z) + (1-x)(y(1-z) + z(1-y)), does not
// grow with x, y or z, hence is at least its value 1/2 at (1/2,1/2,1/2), and exceeds 1/2 elsewhere. So s is
// the block's centre, as near to all corners, and some corner is a surface voxel.
#pragma once

#include <cstdint>
#include <optional>

#include "geometry/point.h"
#include "image/feature_transform.h"
#include "image/isosurface_block.h"
#include "podm/label_image.h"

namespace podm {

class Isosurface {
 public:
  /// Runs the feature transform on `threads` threads (0: all cores). Keeps a reference to `image`.
  /// Throws InputError if the image has more than 2^32 - 1 voxels.
  Isosurface(const LabelImage& image, int threads);

  /// Greatest trilinear weight; a single look-up away from any label change.
  LabelIndex label_at(const Point& p) const;

  /// A lower bound of the distance from p to the isosurface, mm; 0 when p may lie on it. A few look-ups.
  double distance_lower_bound(const Point& p) const;

  /// A point of the isosurface as near to p as the feature transform, marching and local projection find,
  /// if one lies within `radius` of p. Its distance to the true isosurface is below 1e-6 voxel.
  std::optional<Point> closest_point(const Point& p, double radius) const;

  /// The point where the label changes along segment ab, searched from a; none if there is no change.
  /// If the labels at a and b differ one is always found. Double crossings are found down to 1e-6 of the
  /// segment's part in a block.
  std::optional<Point> segment_intersection(const Point& a, const Point& b) const;

 private:
  struct LabelChange {
    double t;  // parameter along the segment
    Voxel block;
    LabelIndex to;
  };

  Point to_voxels(const Point& p) const {
    return {p.x * inverse_spacing_.x, p.y * inverse_spacing_.y, p.z * inverse_spacing_.z};
  }
  Point to_mm(const Point& u) const { return {u.x * spacing_.x, u.y * spacing_.y, u.z * spacing_.z}; }
  double length_mm(const Vector& d) const { return std::sqrt(squared_length(to_mm(d))); }

  // All below in voxels.
  Voxel nearest_voxel(const Point& u) const;
  LabelIndex label_at_voxels(const Point& u) const;
  double feature_bound_mm(const Point& u) const;
  std::optional<LabelChange> first_change(const Point& u, const Vector& d, LabelIndex label) const;
  std::optional<LabelChange> change_in_block(const Point& from, const Point& to, const Voxel& block,
                                             const BlockLabels& labels, LabelIndex label) const;
  std::optional<Voxel> nearest_other_label(const Point& u, FeatureTransform::VoxelIndex feature,
                                           LabelIndex label) const;
  Vector normal_mm(const Point& u, const Voxel& block, LabelIndex a, LabelIndex b) const;
  struct Nearest;
  void improve(const Point& u, LabelIndex label, const Voxel& target, Nearest& best) const;

  LabelGrid grid_;
  FeatureTransform features_;
  Vector spacing_, inverse_spacing_;  // mm a voxel, voxels a mm
  double half_diagonal_mm_;           // of a voxel
};

}  // namespace podm
