// Who is told of the oracle's reads of the image and of its feature transform: nobody, which costs nothing,
// or a worker's tally.
#pragma once

#include <cstddef>

#include "runtime/memory_owners.h"

namespace podm {

/// Which nodes have the labels of the image and the words of the transform, its table and all.
struct ImageOwners {
  MemoryOwners image, transform;

  /// Why reads cannot be counted by node; otherwise empty.
  const std::string& unavailable() const {
    return image.unavailable().empty() ? transform.unavailable() : image.unavailable();
  }
};

/// Counts nothing.
struct NoReads {
  static constexpr void image(std::size_t) {}
  static constexpr void transform(std::size_t) {}
};

/// Counts for one worker.
class CountedReads {
 public:
  CountedReads(const ImageOwners& owners, AccessTally& tally) : owners_(owners), tally_(tally) {}
  /// The label of a voxel, and of voxels after it in its row.
  void image(std::size_t voxel) const { add(AccessKind::kImageRead, owners_.image, voxel); }
  /// A position in FeatureTransform::words().
  void transform(std::size_t word) const { add(AccessKind::kTransformRead, owners_.transform, word); }

 private:
  void add(AccessKind kind, const MemoryOwners& owners, std::size_t element) const {
    tally_.add(kind, owners.node_of(element), owners.address_of(element));
  }

  const ImageOwners& owners_;
  AccessTally& tally_;
};

}  // namespace podm
