// Chains within a block before they become pieces: those too close to be distinguished become one.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "lines/pieces.h"

namespace podm {

/// Distance below which lines of a block, or points on a face of it, count as one, in voxels.
inline constexpr double kMergeDistance = 0.125;
/// Greatest distance of removed points from a polyline, in voxels.
inline constexpr double kSimplifyTolerance = 0.01;

struct Chain {
  std::array<int, 2> ends{-1, -1};  // joints of the block, -1 if the chain is closed
  FewLabels labels;
  std::vector<Point> points;  // the joints' points included

  bool is_closed() const { return ends[0] < 0; }
};

/// A joint of a block. Those that another block emits are not emitted here.
struct BlockJoint {
  Joint joint;
  bool is_emitted;
};

/// The chains and joints of a block.
struct BlockChains {
  std::vector<Chain> chains;
  std::vector<BlockJoint> joints;
  std::uint8_t sides = 0;  // of the box, on which the block's chains lie

  void clear() {
    chains.clear();
    joints.clear();
  }
};

/// Merges what is closer than kMergeDistance:
/// - A chain from a joint to itself that does not leave it by more is removed.
/// - Chains with the same two joints that stay together become one, with the labels of all. Pairs of such
///   chains with the same labels are removed: between them is a layer thinner than the distance.
/// - Where two chains come as close between their ends, both are split, and joined by a new joint.
/// `new_key(n)` names the n-th new joint of the block. Returns a point of each removed pair, and the length
/// of all removed chains, if they are parts of lines.
RemovedCurves merge_chains(BlockChains& block, const std::function<JointKey(std::size_t)>& new_key);

/// Appends the chains and the joints that are emitted, with the background if `has_outside`.
void append(const BlockChains& block, bool has_outside, Pieces& pieces);
/// Appends places of removed chains, which are undecided, and their length.
void append(const RemovedCurves& removed, const Voxel& block, Pieces& pieces);

}  // namespace podm
