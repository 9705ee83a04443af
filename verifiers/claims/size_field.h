// The bound that a size image gives at a cell's circumcentre, over any field that exact.h computes in.
#pragma once

#include <optional>

#include "claims/voxel_map.h"
#include "geometry/measures.h"
#include "image/size_image.h"

namespace podm::verify {

/// Between the centres of voxels the bound is the mean of those of the eight around that have one, by their
/// trilinear weights, times the factor. Voxels at the border reach half a voxel beyond their centres, where a
/// point counts as the nearest between centres. Elsewhere, and where no weight is left, there is no bound.
class SizeField {
 public:
  /// Keeps a reference to the image. `space`: of the mesh, not voxel indices.
  SizeField(const SizeImage& image, double factor, Space space);

  /// Whether the cell's circumradius is over the bound, exactly. A flat cell has neither, and is not.
  bool is_over(const CellPoints& p, std::uint64_t& num_exact) const;
  /// Rounded; infinite where there is none.
  double bound_at_center(const CellPoints& p) const;
  double bound_at(const Point& voxel) const;

 private:
  template <class T>
  struct Mean {
    T sum, weights;  // of radii, and of those that count
  };
  // Nothing: T, which is of intervals then, does not tell between which voxels the point is.
  template <class T>
  std::optional<Mean<T>> mean_at(const Vector<T>& voxel) const;
  template <class T>
  T excess(const CellPoints& p) const;

  const SizeImage& image_;
  Constant factor_;
  VoxelMap to_voxels_;
};

}  // namespace podm::verify
