// Distance from a point to the image's isosurface (image/label_function.h), in the world's mm.
//
// Between the centres of two voxels of different labels that share a face, only these two labels have weight:
// the label changes midway, or of a smoothed image where their strengths say. These midpoints are the known
// points of the isosurface: one lies in each block that it passes through. From the nearest one a search goes
// on to nearer points: wherever a segment's ends have different labels, a point of the isosurface lies
// between, and bisection finds it. The search tries the segment to the midpoint, a voxel's length along each
// axis, and the normals of the surface found. Every answer is a point of the isosurface to 1e-5 of a voxel,
// so that the distance is never taken too small; it may be taken too large, by little.
#pragma once

#include <map>
#include <vector>

#include "claims/check_fidelity_tree.h"
#include "image/image_frame.h"
#include "image/label_function.h"

namespace podm::verify {

/// Where the label changes between two voxels that share a face.
struct Midpoint {
  Point world{};
  std::array<std::uint32_t, 2> labels{};  ///< of the two voxels
  std::uint8_t axis = 0;                  ///< along which they lie
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
  /// Keeps references to frame and midpoints, which are those of `label_function`.
  IsosurfaceDistance(const Image& image, const ImageFrame& frame, const Midpoints& midpoints,
                     const LabelFunction& label_function);

  struct Answer {
    Point point{};
    double squared = std::numeric_limits<double>::infinity();
    LabelWeights labels;  ///< there
    bool bounds(std::uint32_t label) const;
  };
  /// The distance to where any label changes. `hint` is kNone before the first call, then as this function
  /// left it.
  Answer nearest(const Point& p, std::uint32_t& hint) const;
  /// The distance to where `label` begins or ends; none (infinite) if the image lacks it.
  Answer nearest_of_label(const Point& p, std::uint32_t label) const;

 private:
  struct Region;
  Answer search(const Point& p, const Point& known, const Region& region) const;
  bool try_segment(const Point& p, const Point& end, const Region& region, Answer& best) const;
  bool project(const Point& p, const Point& at, const Region& region, Point& target) const;

  const ImageFrame& frame_;
  const Midpoints& midpoints_;
  LabelFunction label_function_;
  std::array<Point, 6> steps_{};  // a voxel along each axis, to and fro
  NearestTree<Midpoints> tree_;
  std::map<std::uint32_t, NearestTree<Midpoints>> tree_of_label_;
};

}  // namespace podm::verify
