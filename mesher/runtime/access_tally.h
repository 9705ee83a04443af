// What a worker counts of its accesses to memory: how many of each kind went to which NUMA node, and where
// some of them were.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace podm {

using NodeIndex = std::uint16_t;  // of a NUMA node, from 0

enum class AccessKind : std::uint8_t {
  kMeshRead,       // a cell tested, a vertex locked
  kMeshWrite,      // a cell made, emptied or glued to, a vertex placed or taken away
  kImageRead,      // labels of voxels beside each other
  kTransformRead,  // a word of the feature transform
  kFirstRead,      // one of these two, of a line that nobody on the node has read; in virtual time alone
};
inline constexpr std::size_t kNumAccessKinds = 5;

class AccessTally {
 public:
  explicit AccessTally(int num_nodes);

  /// `owner`: the node that the memory at `address` belongs to. A call, so that code that counts only on some
  /// machines stays as small as it is without.
  void add(AccessKind kind, NodeIndex owner, const void* address);

  const std::vector<std::uint64_t>& by_node(AccessKind kind) const {
    return by_node_[static_cast<std::size_t>(kind)];
  }
  /// Addresses of the last accesses of any kind, one in a thousand.
  const std::vector<const void*>& samples() const { return samples_; }

 private:
  static constexpr std::size_t kMostSamples = 256;
  static constexpr int kAccessesForOneSample = 1021;  // a prime, in step with no loop

  std::array<std::vector<std::uint64_t>, kNumAccessKinds> by_node_;
  std::vector<const void*> samples_;
  std::size_t oldest_ = 0;
  int until_sample_ = kAccessesForOneSample;
};

}  // namespace podm
