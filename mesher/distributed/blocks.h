// Blocks of cubes with equal shares of the predicted work, one per rank. Blocks are boxes, made by a tree of
// cuts. No rank has a table of all cubes.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "distributed/communication.h"
#include "distributed/cubes.h"

namespace podm {

/// The predicted work of the cubes from `first` on.
struct CubeWork {
  CubeId first = 0;
  std::vector<std::uint32_t> of_cube;
};

/// Assigns each cube to a block, by weighted bisection along the longest axis. Some blocks have no cube if
/// there are many ranks and few cubes.
class Blocks {
 public:
  /// Makes one block per rank. The ranks' parts of the work are those of all cubes, each once. Collective.
  Blocks(const CubeGrid& grid, const CubeWork& own, Communication& ranks);
  /// Draws the cuts at random, independent of the work: some blocks are one cube thin, some hold nearly all
  /// cubes. Each block has a cube if there are enough cubes.
  Blocks(const CubeGrid& grid, std::uint64_t seed, int num_blocks);
  int number() const { return static_cast<int>(cuts_.size()) + 1; }
  int of(const CubePlace& at) const {
    int block = 0;
    descend([&](const Cut& cut) {
      const bool is_below = at[cut.axis] < cut.at;
      if (!is_below) block += cut.blocks_below;
      return is_below;
    });
    return block;
  }
  /// Returns the cubes of a block.
  CubeRange range_of(int block) const;

 private:
  struct Part;
  class Bisection;
  // A plane, and the number of blocks below it: the cut divides space into the cubes below `at` and others.
  struct Cut {
    std::size_t axis;
    int at, blocks_below;
  };
  // Follows the cuts from the root. `is_below` decides the side.
  template <class IsBelow>
  void descend(const IsBelow& is_below) const {
    for (std::size_t cut = 0, count = cuts_.size() + 1; count > 1;) {
      const auto below = static_cast<std::size_t>(cuts_[cut].blocks_below);
      if (is_below(cuts_[cut])) {
        count = below;
        ++cut;
      } else {
        count -= below;
        cut += below;
      }
    }
  }
  static Cut drawn_cut(const Part& part, std::mt19937_64& random);
  void draw(const Part& part, std::mt19937_64& random);
  // Sets the cut of the part, and returns what is below and above.
  std::array<Part, 2> divide(const Part& part, const Cut& cut);

  CubeRange all_;
  std::vector<Cut> cuts_;  // of a part, then of what is below, then of what is above
};

}  // namespace podm
