// Receivers of the oracle's reads of the image and of its feature transform. One receiver ignores them at no
// cost; the other adds them to a worker's tally.
#pragma once

#include <cstddef>
#include <memory>

#include "runtime/memory_owners.h"
#include "runtime/read_lines.h"

namespace podm {

/// The memory nodes that hold the labels of the image and the words of the transform, including its table.
struct ImageOwners {
  MemoryOwners image, transform;
  /// The lines that each node has read so far; null if first reads are not counted.
  std::unique_ptr<ReadLines> read_image = nullptr, read_transform = nullptr;

  /// From now on first reads are counted separately. No line counts as read before. All reads must come from
  /// one thread.
  void watch_first_reads(int num_nodes) {
    read_image = std::make_unique<ReadLines>(image.num_bytes(), num_nodes);
    read_transform = std::make_unique<ReadLines>(transform.num_bytes(), num_nodes);
  }

  /// The reason why reads cannot be counted by node; empty if they can.
  const std::string& unavailable() const {
    return image.unavailable().empty() ? transform.unavailable() : image.unavailable();
  }
};

struct NoReads {
  static constexpr void image(std::size_t) {}
  static constexpr void transform(std::size_t) {}
};

/// Counts for one worker, which runs on `node`.
class CountedReads {
 public:
  CountedReads(const ImageOwners& owners, AccessTally& tally, NodeIndex node = 0)
      : owners_(owners), tally_(tally), node_(node) {}
  /// A read of the label of a voxel, and of voxels after it in its row.
  void image(std::size_t voxel) const {
    add(AccessKind::kImageRead, owners_.image, owners_.read_image.get(), voxel);
  }
  /// A read at a position in FeatureTransform::words().
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
