// The bound of a size image at a cell's circumcenter, over any field that exact.h computes in.
#pragma once

#include <optional>

#include "claims/voxel_map.h"
#include "geometry/measures.h"
#include "image/size_image.h"

namespace podm::verify {

/// Between the centers of voxels the bound is the mean over those of the eight voxels around that have a
/// bound, by their trilinear weights, times the factor. Voxels at the border reach half a voxel beyond their
/// centers; a point there counts as the nearest point between centers. Elsewhere, and where no weight is
/// left, there is no bound.
class SizeField {
 public:
  /// Keeps a reference to the image. `space` is the mesh's; it must not be voxel indices.
  SizeField(const SizeImage& image, double factor, Space space);

  /// True if the cell's circumradius is over the bound, decided exactly; false for a flat cell, which has no
  /// circumradius.
  bool is_over(const CellPoints& p, std::uint64_t& num_exact) const;
  /// Returns the rounded bound; infinite if there is none.
  double bound_at_center(const CellPoints& p) const;
  double bound_at(const Point& voxel) const;

 private:
  template <class T>
  struct Mean {
    T sum, weights;  // sums of weighted radii, and of the weights of voxels with a bound
  };
  // Returns nothing if T is of intervals that leave open between which voxels the point is.
  template <class T>
  std::optional<Mean<T>> mean_at(const Vector<T>& voxel) const;
  template <class T>
  T excess(const CellPoints& p) const;

  const SizeImage& image_;
  Constant factor_;
  VoxelMap to_voxels_;
};

}  // namespace podm::verify
