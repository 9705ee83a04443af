// Who is told of the oracle's reads of the image and of its feature transform: nobody, which costs nothing,
// or a worker's tally.
#pragma once

#include <cstddef>
#include <memory>

#include "runtime/memory_owners.h"
#include "runtime/read_lines.h"

namespace podm {

/// Which nodes have the labels of the image and the words of the transform, its table and all.
struct ImageOwners {
  MemoryOwners image, transform;
  /// What the nodes' caches have of them; none: nobody asks.
  std::unique_ptr<ReadLines> read_image = nullptr, read_transform = nullptr;

  /// From now on first reads are told apart, and none was before. All reads must come from one thread.
  void watch_first_reads(int num_nodes) {
    read_image = std::make_unique<ReadLines>(image.num_bytes(), num_nodes);
    read_transform = std::make_unique<ReadLines>(transform.num_bytes(), num_nodes);
  }

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

/// Counts for one worker, of that node.
class CountedReads {
 public:
  CountedReads(const ImageOwners& owners, AccessTally& tally, NodeIndex node = 0)
      : owners_(owners), tally_(tally), node_(node) {}
  /// The label of a voxel, and of voxels after it in its row.
  void image(std::size_t voxel) const {
    add(AccessKind::kImageRead, owners_.image, owners_.read_image.get(), voxel);
  }
  /// A position in FeatureTransform::words().
  void transform(std::size_t word) const {
    add(AccessKind::kTransformRead, owners_.transform, owners_.read_transform.get(), word);
  }

 private:
  void add(AccessKind kind, const MemoryOwners& owners, ReadLines* lines, std::size_t element) const {
    tally_.add(kind, owners.node_of(element), owners.address_of(element));
    if (lines != nullptr && lines->is_first(node_, owners.byte_of(element)))
      tally_.add(AccessKind::kFirstRead, owners.node_of(element), owners.address_of(element));
  }

  const ImageOwners& owners_;
  AccessTally& tally_;
  NodeIndex node_;
};

}  // namespace podm
