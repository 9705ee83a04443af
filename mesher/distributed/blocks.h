// Blocks of cubes with equal shares of the predicted work, one a rank.
#pragma once

#include <random>
#include <vector>

#include "distributed/cubes.h"

namespace podm {

/// Each cube's share of the work, by weighted bisection along the longest axis. Some blocks have no cube
/// where ranks are many and cubes few.
class Blocks {
 public:
  /// `weights`: one a cube.
  Blocks(const CubeGrid& grid, const std::vector<std::uint64_t>& weights, int num_blocks);
  /// Cuts are drawn, whatever the work: some blocks are one cube thin, some hold nearly all. Each has a cube
  /// if there are enough.
  Blocks(const CubeGrid& grid, std::uint64_t seed, int num_blocks);
  /// Where a part is cut in two, and how many of its blocks lie below.
  struct Cut {
    std::size_t axis;
    int cubes_below, blocks_below;
  };
  /// In the order of cutting: first the whole, then the part below, all of it, and then the part above.
  const std::vector<Cut>& cuts() const { return cuts_; }
  /// The blocks that were cut so.
  Blocks(const CubeGrid& grid, const std::vector<Cut>& cuts);

  int of(CubeId cube) const { return block_of_[cube]; }
  const std::vector<int>& ranks() const { return block_of_; }

 private:
  struct Part;
  Cut cut_by_weight(const Part& part, const std::vector<std::uint64_t>& weights) const;
  static Cut drawn_cut(const Part& part, std::mt19937_64& random);
  template <class CutOf>
  void divide(const Part& part, const CutOf& cut_of);

  const CubeGrid& grid_;
  std::vector<int> block_of_;
  std::vector<Cut> cuts_;
};

}  // namespace podm
