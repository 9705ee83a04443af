#include "distributed/blocks.h"

#include <algorithm>
#include <cmath>

namespace podm {

// Cubes, and the blocks that share them.
struct Blocks::Part {
  CubeRange cubes;
  int first_block, num_blocks;
};

Blocks::Blocks(const CubeGrid& grid, const std::vector<std::uint64_t>& weights, int num_blocks)
    : grid_(grid), block_of_(grid.num_cubes()) {
  divide({grid.all(), 0, num_blocks}, [&](const Part& part) { return cut_by_weight(part, weights); });
}

Blocks::Blocks(const CubeGrid& grid, std::uint64_t seed, int num_blocks)
    : grid_(grid), block_of_(grid.num_cubes()) {
  std::mt19937_64 random(seed);
  divide({grid.all(), 0, num_blocks}, [&](const Part& part) { return drawn_cut(part, random); });
}

template <class CutOf>
void Blocks::divide(const Part& part, const CutOf& cut_of) {
  if (part.num_blocks == 1) {
    grid_.for_each(part.cubes, [&](CubeId cube, const CubePlace&) { block_of_[cube] = part.first_block; });
    return;
  }
  const Cut cut = cut_of(part);
  Part lower = part, upper = part;
  lower.cubes.high[cut.axis] = upper.cubes.low[cut.axis] = part.cubes.low[cut.axis] + cut.cubes_below;
  lower.num_blocks = cut.blocks_below;
  upper.first_block += cut.blocks_below;
  upper.num_blocks -= cut.blocks_below;
  divide(lower, cut_of);
  divide(upper, cut_of);
}

// Returns a cut along a plane between cubes, across the axis along which the cubes with weight extend
// farthest. The plane is the one that comes nearest to the share of the blocks on either side.
Blocks::Cut Blocks::cut_by_weight(const Part& part, const std::vector<std::uint64_t>& weights) const {
  CubeRange heavy{part.cubes.high, part.cubes.low};
  grid_.for_each(part.cubes, [&](CubeId cube, const CubePlace& at) {
    for (std::size_t axis = 0; axis < 3 && weights[cube] > 0; ++axis) {
      heavy.low[axis] = std::min(heavy.low[axis], at[axis]);
      heavy.high[axis] = std::max(heavy.high[axis], at[axis] + 1);
    }
  });
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other)
    if (heavy.length(other) > heavy.length(axis)) axis = other;
  const std::vector<std::uint64_t> weight_below = grid_.weights_below(part.cubes, axis, weights);
  const int below = part.num_blocks / 2;
  const double wanted = static_cast<double>(weight_below.back()) * below / part.num_blocks;
  const auto off = [&](std::uint64_t weight) { return std::abs(static_cast<double>(weight) - wanted); };
  const auto is_nearer = [&](std::uint64_t a, std::uint64_t b) { return off(a) < off(b); };
  const auto cut =
      std::min_element(weight_below.begin(), weight_below.end(), is_nearer) - weight_below.begin();
  return {axis, static_cast<int>(cut), below};
}

Blocks::Cut Blocks::drawn_cut(const Part& part, std::mt19937_64& random) {
  constexpr double kThinShare = 0.25;
  const auto draw = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto length = [&](std::size_t axis) { return part.cubes.length(axis); };
  std::size_t axis = static_cast<std::size_t>(draw(0, 2));
  for (int i = 0; i < 2 && length(axis) < 2; ++i) axis = (axis + 1) % 3;
  if (length(axis) < 2) return {axis, length(axis), part.num_blocks / 2};
  const int cut = std::bernoulli_distribution(kThinShare)(random) ? 1 : draw(1, length(axis) - 1);
  const int area = length((axis + 1) % 3) * length((axis + 2) % 3);
  const int least = std::max(1, part.num_blocks - area * (length(axis) - cut));
  const int most = std::min(part.num_blocks - 1, area * cut);
  return {axis, cut, draw(std::min(least, most), most)};
}

}  // namespace podm
