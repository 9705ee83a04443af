#include "distributed/blocks.h"

#include <algorithm>
#include <cmath>

namespace podm {

// Cubes from `low` to before `high`, and the blocks that share them.
struct Blocks::Part {
  CubePlace low, high;
  int first_block, num_blocks;
};

namespace {

template <class Visit>
void for_each_cube(const CubeGrid& grid, const CubePlace& low, const CubePlace& high, const Visit& visit) {
  for (int z = low[2]; z < high[2]; ++z)
    for (int y = low[1]; y < high[1]; ++y)
      for (int x = low[0]; x < high[0]; ++x) visit(grid.id({x, y, z}), CubePlace{x, y, z});
}

}  // namespace

Blocks::Blocks(const CubeGrid& grid, const std::vector<std::uint64_t>& weights, int num_blocks)
    : grid_(grid), block_of_(grid.num_cubes()) {
  divide({{0, 0, 0}, grid.size(), 0, num_blocks},
         [&](const Part& part) { return cut_by_weight(part, weights); });
}

Blocks::Blocks(const CubeGrid& grid, std::uint64_t seed, int num_blocks)
    : grid_(grid), block_of_(grid.num_cubes()) {
  std::mt19937_64 random(seed);
  divide({{0, 0, 0}, grid.size(), 0, num_blocks}, [&](const Part& part) { return drawn_cut(part, random); });
}

// Each cut makes one block more.
Blocks::Blocks(const CubeGrid& grid, const std::vector<Cut>& cuts)
    : grid_(grid), block_of_(grid.num_cubes()) {
  auto next = cuts.begin();
  divide({{0, 0, 0}, grid.size(), 0, static_cast<int>(cuts.size()) + 1},
         [&](const Part&) { return *next++; });
}

std::vector<int> Blocks::in(const CubePlace& low, const CubePlace& high) const {
  std::vector<int> blocks;
  collect(0, low, high, blocks);
  return blocks;
}

void Blocks::collect(std::size_t node_id, const CubePlace& low, const CubePlace& high,
                     std::vector<int>& blocks) const {
  const Node& node = nodes_[node_id];
  if (node.above == 0) {
    blocks.push_back(node.block);
    return;
  }
  CubePlace high_below = high, low_above = low;
  high_below[node.axis] = std::min(high[node.axis], node.cut - 1);
  low_above[node.axis] = std::max(low[node.axis], node.cut);
  if (low[node.axis] <= high_below[node.axis]) collect(node_id + 1, low, high_below, blocks);
  if (low_above[node.axis] <= high[node.axis]) collect(node.above, low_above, high, blocks);
}

template <class CutOf>
void Blocks::divide(const Part& part, const CutOf& cut_of) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({.block = part.first_block});
  if (part.num_blocks == 1) {
    for_each_cube(grid_, part.low, part.high,
                  [&](CubeId cube, const CubePlace&) { block_of_[cube] = part.first_block; });
    return;
  }
  const Cut cut = cut_of(part);
  cuts_.push_back(cut);
  Part lower = part, upper = part;
  lower.high[cut.axis] = upper.low[cut.axis] = part.low[cut.axis] + cut.cubes_below;
  lower.num_blocks = cut.blocks_below;
  upper.first_block += cut.blocks_below;
  upper.num_blocks -= cut.blocks_below;
  divide(lower, cut_of);
  nodes_[node] = {.axis = cut.axis, .cut = upper.low[cut.axis], .above = nodes_.size()};
  divide(upper, cut_of);
}

// Cuts are planes between cubes, across the axis along which what weighs anything is longest: at the one that
// comes nearest to the share of the blocks on either side.
Blocks::Cut Blocks::cut_by_weight(const Part& part, const std::vector<std::uint64_t>& weights) const {
  CubePlace low = part.high, high = part.low;  // of what has weight
  for_each_cube(grid_, part.low, part.high, [&](CubeId cube, const CubePlace& at) {
    for (std::size_t axis = 0; axis < 3 && weights[cube] > 0; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis] + 1);
    }
  });
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other)
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  std::vector<std::uint64_t> weight_below(static_cast<std::size_t>(part.high[axis] - part.low[axis]) + 1);
  for_each_cube(grid_, part.low, part.high, [&](CubeId cube, const CubePlace& at) {
    weight_below[static_cast<std::size_t>(at[axis] - part.low[axis]) + 1] += weights[cube];
  });
  for (std::size_t i = 1; i < weight_below.size(); ++i) weight_below[i] += weight_below[i - 1];
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
  const auto length = [&](std::size_t axis) { return part.high[axis] - part.low[axis]; };
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
