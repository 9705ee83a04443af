// A worker's counts of its accesses to memory: the number of each kind per NUMA node, and the addresses of a
// sample.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace podm {

using NodeIndex = std::uint16_t;  // NUMA node, from 0

enum class AccessKind : std::uint8_t {
  kMeshRead,       // a cell tested, a vertex locked
  kMeshWrite,      // a cell made, emptied or glued to, a vertex placed or removed
  kImageRead,      // labels of adjacent voxels
  kTransformRead,  // a word of the feature transform
  kFirstRead,      // an image or transform read, the node's first of that line; only in virtual time
};
inline constexpr std::size_t kNumAccessKinds = 5;

class AccessTally {
 public:
  explicit AccessTally(int num_nodes);

  /// Counts an access. `owner` is the node that the memory at `address` belongs to. Not inline, so that code
  /// that counts only on some machines stays as small as without counts.
  void add(AccessKind kind, NodeIndex owner, const void* address);

  const std::vector<std::uint64_t>& by_node(AccessKind kind) const {
    return by_node_[static_cast<std::size_t>(kind)];
  }
  /// Returns the addresses of the last sampled accesses of any kind, about one in a thousand.
  const std::vector<const void*>& samples() const { return samples_; }

 private:
  static constexpr std::size_t kMostSamples = 256;
  static constexpr int kAccessesForOneSample = 1021;  // a prime: no loop is in step with it

  std::array<std::vector<std::uint64_t>, kNumAccessKinds> by_node_;
  std::vector<const void*> samples_;
  std::size_t oldest_ = 0;
  int until_sample_ = kAccessesForOneSample;
};

}  // namespace podm
