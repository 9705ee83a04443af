// Distance from a point to the image's isosurface (image/label_function.h), in the world's mm.
//
// Between the centers of two voxels of different labels that share a face, only these two labels have weight.
// The label changes midway, or in a smoothed image where their voxel weights place it. These midpoints are
// the known points of the isosurface: one lies in each block that the isosurface passes through. From the
// nearest midpoint a search goes on to nearer points. If the ends of a segment have different labels, a point
// of the isosurface lies between them, and bisection finds it. The search tries the segment to the midpoint,
// a voxel's length along each axis, and the normals of the surface found. Every answer is a point of the
// isosurface to 1e-5 of a voxel. The distance is therefore never too small; it may be slightly too large.
#pragma once

#include <map>
#include <vector>

#include "claims/check_fidelity_tree.h"
#include "image/image_frame.h"
#include "image/label_function.h"

namespace podm::verify {

/// The point where the label changes between two voxels that share a face.
struct Midpoint {
  Point world{};
  std::array<std::uint32_t, 2> labels{};  ///< of the two voxels
  std::uint8_t axis = 0;                  ///< axis along which the voxels lie
};

class Midpoints {
 public:
  Midpoints(const Image& image, const ImageFrame& frame, const LabelFunction& label_function);
  const std::vector<Midpoint>& all() const { return midpoints_; }
  Point closest(std::uint32_t i, const Point&) const { return midpoints_[i].world; }
  void bounds(std::uint32_t i, Point& low, Point& high) const { low = high = midpoints_[i].world; }

 private:
  std::vector<Midpoint> midpoints_;
};

class IsosurfaceDistance {
 public:
  /// Keeps references to frame and midpoints. The midpoints must be those of `label_function`.
  IsosurfaceDistance(const Image& image, const ImageFrame& frame, const Midpoints& midpoints,
                     const LabelFunction& label_function);

  struct Answer {
    Point point{};
    double squared = std::numeric_limits<double>::infinity();
    LabelWeights labels;  ///< at the point
    bool bounds(std::uint32_t label) const;
  };
  /// Returns the distance to where any label changes. `hint` is kNone before the first call, then as the
  /// previous call left it.
  Answer nearest(const Point& p, std::uint32_t& hint) const;
  /// Returns the distance to where `label` begins or ends; infinite if the image lacks the label.
  Answer nearest_of_label(const Point& p, std::uint32_t label) const;

 private:
  struct Region;
  Answer search(const Point& p, const Point& known, const Region& region) const;
  bool try_segment(const Point& p, const Point& end, const Region& region, Answer& best) const;
  bool project(const Point& p, const Point& at, const Region& region, Point& target) const;

  const ImageFrame& frame_;
  const Midpoints& midpoints_;
  LabelFunction label_function_;
  std::array<Point, 6> steps_{};  // a voxel along each axis, in both directions
  NearestTree<Midpoints> tree_;
  std::map<std::uint32_t, NearestTree<Midpoints>> tree_of_label_;
};

}  // namespace podm::verify
