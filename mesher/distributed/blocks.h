// Blocks of cubes with equal shares of the predicted work, one per rank.
#pragma once

#include <random>
#include <vector>

#include "distributed/cubes.h"

namespace podm {

/// Assigns each cube to a block, by weighted bisection along the longest axis. Some blocks have no cube if
/// there are many ranks and few cubes.
class Blocks {
 public:
  /// `weights`: one per cube.
  Blocks(const CubeGrid& grid, const std::vector<std::uint64_t>& weights, int num_blocks);
  /// Draws the cuts at random, independent of the work: some blocks are one cube thin, some hold nearly all
  /// cubes. Each block has a cube if there are enough cubes.
  Blocks(const CubeGrid& grid, std::uint64_t seed, int num_blocks);
  int of(CubeId cube) const { return block_of_[cube]; }
  const std::vector<int>& ranks() const { return block_of_; }

 private:
  struct Part;
  // The plane that cuts a part in two, and the number of the part's blocks below the plane.
  struct Cut {
    std::size_t axis;
    int cubes_below, blocks_below;
  };
  Cut cut_by_weight(const Part& part, const std::vector<std::uint64_t>& weights) const;
  static Cut drawn_cut(const Part& part, std::mt19937_64& random);
  template <class CutOf>
  void divide(const Part& part, const CutOf& cut_of);

  const CubeGrid& grid_;
  std::vector<int> block_of_;
};

}  // namespace podm
