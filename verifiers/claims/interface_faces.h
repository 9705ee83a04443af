// The interface of some labels and others in an image, and how far cells are from it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "claims/circumsphere.h"
#include "geometry/box_tree.h"
#include "image/image.h"
#include "image/size_near.h"

namespace podm::verify {

/// A rectangle between a voxel and the one before it along an axis.
struct VoxelFace {
  std::array<std::int32_t, 3> voxel;
  std::uint32_t axis;
};

/// The faces between voxels of labels of one side and face neighbours with labels of the other; outside the
/// grid all is background. Distances are taken in mm along the image's own axes. About 30 bytes a face, and
/// 50 more while it is made.
class InterfaceFaces {
 public:
  /// Throws InputError: a label that the image does not have or that is on both sides; sides that do not
  /// touch.
  InterfaceFaces(const Image& image, const SizeNear& near);

  const SizeNear& near() const { return near_; }
  std::size_t size() const { return faces_.size(); }
  /// Whether the cell's circumcentre is within the width, exactly. `sphere` is the cell's.
  bool contains(const CellPoints& p, const Circumsphere& sphere, const VoxelMap& to_voxels,
                std::uint64_t& num_exact) const;
  /// The distance of the nearest face, rounded, where it is below `limit_mm`; else `limit_mm`.
  double distance_mm(const Point& voxel, double limit_mm) const;

 private:
  Point in_mm(const Point& voxel) const;
  Bounds box_of(const VoxelFace& face) const;
  std::vector<Bounds> boxes() const;
  template <class T>
  T excess(const VoxelFace& face, const CellPoints& p, const VoxelMap& to_voxels) const;

  SizeNear near_;
  std::array<double, 3> spacing_;
  std::vector<VoxelFace> faces_;
  BoxTree tree_;
};

}  // namespace podm::verify
