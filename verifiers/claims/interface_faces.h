// The interface between two groups of labels in an image, and the distance of cells from it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "claims/circumsphere.h"
#include "geometry/box_tree.h"
#include "image/image.h"
#include "image/interface_size.h"

namespace podm::verify {

/// A rectangle between a voxel and the voxel before it along an axis.
struct VoxelFace {
  std::array<std::int32_t, 3> voxel;
  std::uint32_t axis;
};

/// The faces between voxels with labels of one side and face neighbours with labels of the other. Outside the
/// grid all is background. Distances are in mm along the image's own axes. Takes about 30 bytes per face, and
/// 50 more during construction.
class InterfaceFaces {
 public:
  /// Throws InputError if the image does not have a label, if a label is on both sides, or if the sides do
  /// not touch.
  InterfaceFaces(const Image& image, const InterfaceSize& near);

  const InterfaceSize& near() const { return bound_; }
  std::size_t size() const { return faces_.size(); }
  /// True if the cell's circumcenter is within the width, decided exactly. `sphere` is the cell's
  /// circumsphere.
  bool contains(const CellPoints& p, const Circumsphere& sphere, const VoxelMap& to_voxels,
                std::uint64_t& num_exact) const;
  /// Returns the distance of the nearest face, rounded, if it is below `limit_mm`; otherwise `limit_mm`.
  double distance_mm(const Point& voxel, double limit_mm) const;

 private:
  Point in_mm(const Point& voxel) const;
  Bounds box_of(const VoxelFace& face) const;
  std::vector<Bounds> boxes() const;
  template <class T>
  T excess(const VoxelFace& face, const CellPoints& p, const VoxelMap& to_voxels) const;

  InterfaceSize bound_;
  std::array<double, 3> spacing_;
  std::vector<VoxelFace> faces_;
  BoxTree tree_;
};

}  // namespace podm::verify
