// Blocks of cubes with equal shares of the predicted work, one a rank.
#pragma once

#include <vector>

#include "distributed/cubes.h"

namespace podm {

/// Each cube's share of the work, by weighted bisection along the longest axis: the same on all ranks that
/// have the same weights, without a message. Some blocks have no cube where ranks are many and cubes few.
class Blocks {
 public:
  /// `weights`: one a cube, not negative.
  Blocks(const CubeGrid& grid, const std::vector<std::uint64_t>& weights, int num_blocks);

  const CubeGrid& grid() const { return grid_; }
  int of(CubeId cube) const { return block_of_[cube]; }
  const std::vector<int>& ranks() const { return block_of_; }
  /// Cubes that have another block within so many cubes along each axis.
  CubeSet near_others(int rings) const;
  int number() const { return num_blocks_; }

 private:
  struct Part;
  void divide(const Part& part, const std::vector<std::uint64_t>& weights);

  const CubeGrid& grid_;
  int num_blocks_;
  std::vector<int> block_of_;
};

}  // namespace podm
