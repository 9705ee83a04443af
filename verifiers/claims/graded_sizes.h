// Bounds on circumradii that grow with the distance from where others hold, as --grade says.
#pragma once

#include <array>
#include <vector>

#include "claims/interface_faces.h"
#include "claims/minima_pyramid.h"
#include "image/image.h"
#include "image/size_image.h"
#include "options.h"

namespace podm::verify {

/// The least s for which nodes at every s-th voxel of a grid are no more than 2^26.
int stride_of_nodes(const std::array<int, 3>& size);

/// What check_size.cpp states of a grade, computed in doubles; options.grade must be set.
class GradedSizes {
 public:
  /// Keeps a reference to `near`. `sizes` null: none are by place.
  GradedSizes(const Image& image, const SizeImage* sizes, const std::vector<InterfaceFaces>& near,
              const Options& options);

  /// The bound at a place, in voxels, slack included, where it is below `limit_mm`; else `limit_mm`.
  double bound_at(const Point& voxel, double limit_mm) const;
  /// Whether it is below `radius_mm`.
  bool is_exceeded_at(const Point& voxel, double radius_mm) const;
  /// By how much a cell may be over what grows from voxels, and from interfaces; rounding apart.
  double slack_of_voxels_mm() const { return slack_of_voxels_mm_; }
  double slack_of_interfaces_mm() const { return slack_of_interfaces_mm_; }

 private:
  // The bound of voxels alone, as by bound_at(); one below `enough_mm` may be another than the least.
  double bound_of_voxels(const Point& voxel, double limit_mm, double enough_mm) const;
  double bound_of_interface(const InterfaceFaces& faces, const Point& voxel, double limit_mm) const;

  double slope_;
  const std::vector<InterfaceFaces>& near_;
  MinimaPyramid voxels_;
  double rounding_, slack_of_voxels_mm_, slack_of_interfaces_mm_;
};

}  // namespace podm::verify
