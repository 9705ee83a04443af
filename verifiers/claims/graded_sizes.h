// Bounds on circumradii that grow with the distance from where other bounds hold, as --grade demands.
#pragma once

#include <array>
#include <vector>

#include "claims/interface_faces.h"
#include "claims/minima_pyramid.h"
#include "image/image.h"
#include "image/size_image.h"
#include "options.h"

namespace podm::verify {

/// Returns the least s for which nodes at every s-th voxel of a grid are at most 2^26.
int stride_of_nodes(const std::array<int, 3>& size);

/// The bound that check_size.cpp states for a grade, computed in doubles. options.grade must be set.
class GradedSizes {
 public:
  /// Keeps a reference to `near`. `sizes` null: there is no size image.
  GradedSizes(const Image& image, const SizeImage* sizes, const std::vector<InterfaceFaces>& near,
              const Options& options);

  /// Returns the bound at a place, in voxels, slack included, if it is below `limit_mm`; otherwise
  /// `limit_mm`.
  double bound_at(const Point& voxel, double limit_mm) const;
  /// True if the bound at the place is below `radius_mm`.
  bool is_exceeded_at(const Point& voxel, double radius_mm) const;
  /// These return by how much a cell may exceed bounds that grow from voxels, or from interfaces, without
  /// rounding.
  double slack_of_voxels_mm() const { return slack_of_voxels_mm_; }
  double slack_of_interfaces_mm() const { return slack_of_interfaces_mm_; }

 private:
  // Returns the bound of voxels alone, as bound_at() does. A result below `enough_mm` need not be the least.
  double bound_of_voxels(const Point& voxel, double limit_mm, double enough_mm) const;
  double bound_of_interface(const InterfaceFaces& faces, const Point& voxel, double limit_mm) const;

  double slope_;
  const std::vector<InterfaceFaces>& near_;
  MinimaPyramid voxels_;
  double rounding_, slack_of_voxels_mm_, slack_of_interfaces_mm_;
};

}  // namespace podm::verify
