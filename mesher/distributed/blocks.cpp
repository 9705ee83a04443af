#include "distributed/blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

namespace podm {

// Cubes, and the blocks that share them.
struct Blocks::Part {
  CubeRange cubes;
  int num_blocks;
  std::size_t first_cut = 0;
};

std::array<Blocks::Part, 2> Blocks::divide(const Part& part, const Cut& cut) {
  cuts_[part.first_cut] = cut;
  Part lower = part, upper = part;
  lower.cubes.high[cut.axis] = upper.cubes.low[cut.axis] = cut.at;
  lower.num_blocks = cut.blocks_below;
  lower.first_cut = part.first_cut + 1;
  upper.num_blocks = part.num_blocks - cut.blocks_below;
  upper.first_cut = part.first_cut + static_cast<std::size_t>(cut.blocks_below);
  return {lower, upper};
}

// Cuts all parts of a level at once. Each rank adds up the work of its own cubes, and the ranks exchange
// sums.
class Blocks::Bisection {
 public:
  Bisection(const CubeGrid& grid, const CubeWork& own, Communication& ranks) : grid_(grid), ranks_(ranks) {
    for (std::size_t i = 0; i < own.of_cube.size(); ++i)
      if (own.of_cube[i] > 0)
        heavy_.push_back({grid.place_of(own.first + static_cast<CubeId>(i)), own.of_cube[i], 0});
  }

  /// Returns the cuts of the parts, none for a part of one block.
  std::vector<std::optional<Cut>> cuts_of(const std::vector<Part>& parts) const {
    const std::vector<std::size_t> axes = longest_axes(parts);
    std::vector<std::size_t> first_plane{0};
    for (std::size_t i = 0; i < parts.size(); ++i)
      first_plane.push_back(first_plane.back() + static_cast<std::size_t>(parts[i].cubes.length(axes[i])));
    std::vector<std::uint64_t> work(first_plane.back());
    for (const Heavy& cube : heavy_) {
      const std::size_t part = cube.part, axis = axes[part];
      work[first_plane[part] + static_cast<std::size_t>(cube.at[axis] - parts[part].cubes.low[axis])] +=
          cube.work;
    }
    ranks_.sum(work);
    std::vector<std::optional<Cut>> cuts(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].num_blocks > 1)
        cuts[i] = cut_of(parts[i], axes[i], {&work[first_plane[i]], &work[first_plane[i + 1]]});
    return cuts;
  }

  /// Notes that part i was divided into the parts 2 i and 2 i + 1, or that it is part 2 i if it has no cut.
  void follow(const std::vector<std::optional<Cut>>& cuts) {
    for (Heavy& cube : heavy_) {
      const auto& cut = cuts[cube.part];
      cube.part = 2 * cube.part + (cut && cube.at[cut->axis] >= cut->at ? 1 : 0);
    }
  }

 private:
  struct Heavy {
    CubePlace at;
    std::uint32_t work, part;
  };

  // Returns for each part the axis along which the cubes with work extend farthest.
  std::vector<std::size_t> longest_axes(const std::vector<Part>& parts) const {
    const auto above = [&](std::size_t axis, int at) {
      return static_cast<std::uint64_t>(grid_.size()[axis] - at);
    };
    std::vector<std::uint64_t> bounds(6 * parts.size());  // the size less the lowest place, and the end
    for (const Heavy& cube : heavy_)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::uint64_t* const of_axis = &bounds[6 * cube.part + 2 * axis];
        of_axis[0] = std::max(of_axis[0], above(axis, cube.at[axis]));
        of_axis[1] = std::max(of_axis[1], static_cast<std::uint64_t>(cube.at[axis]) + 1);
      }
    ranks_.maximum(bounds);
    std::vector<std::size_t> axes;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto length = [&](std::size_t axis) {
        const std::uint64_t* const of_axis = &bounds[6 * i + 2 * axis];
        const auto size = static_cast<std::uint64_t>(grid_.size()[axis]);
        return of_axis[1] == 0 ? -std::int64_t{parts[i].cubes.length(axis)}
                               : static_cast<std::int64_t>(of_axis[1] + of_axis[0] - size);
      };
      std::size_t axis = 0;
      for (std::size_t other = 1; other < 3; ++other)
        if (length(other) > length(axis)) axis = other;
      axes.push_back(axis);
    }
    return axes;
  }

  // Returns the plane between cubes that comes nearest to the share of the blocks on either side.
  static Cut cut_of(const Part& part, std::size_t axis, std::span<const std::uint64_t> work) {
    std::vector<std::uint64_t> work_below(work.size() + 1);
    std::partial_sum(work.begin(), work.end(), work_below.begin() + 1);
    const int below = part.num_blocks / 2;
    const double wanted = static_cast<double>(work_below.back()) * below / part.num_blocks;
    const auto off = [&](std::uint64_t sum) { return std::abs(static_cast<double>(sum) - wanted); };
    const auto cut = std::min_element(work_below.begin(), work_below.end(),
                                      [&](std::uint64_t a, std::uint64_t b) { return off(a) < off(b); }) -
                     work_below.begin();
    return {axis, part.cubes.low[axis] + static_cast<int>(cut), below};
  }

  const CubeGrid& grid_;
  Communication& ranks_;
  std::vector<Heavy> heavy_;  // this rank's cubes with work
};

Blocks::Blocks(const CubeGrid& grid, const CubeWork& own, Communication& ranks)
    : all_(grid.all()), cuts_(static_cast<std::size_t>(ranks.size()) - 1) {
  Bisection bisection(grid, own, ranks);
  std::vector<Part> parts{{all_, ranks.size()}};
  while (std::any_of(parts.begin(), parts.end(), [](const Part& part) { return part.num_blocks > 1; })) {
    const std::vector<std::optional<Cut>> cuts = bisection.cuts_of(parts);
    std::vector<Part> next;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto [lower, upper] = cuts[i] ? divide(parts[i], *cuts[i]) : std::array{parts[i], Part{{}, 0}};
      next.insert(next.end(), {lower, upper});
    }
    bisection.follow(cuts);
    parts = std::move(next);
  }
}

Blocks::Blocks(const CubeGrid& grid, std::uint64_t seed, int num_blocks)
    : all_(grid.all()), cuts_(static_cast<std::size_t>(num_blocks) - 1) {
  std::mt19937_64 random(seed);
  draw({all_, num_blocks}, random);
}

void Blocks::draw(const Part& part, std::mt19937_64& random) {
  if (part.num_blocks == 1) return;
  const auto [lower, upper] = divide(part, drawn_cut(part, random));
  draw(lower, random);
  draw(upper, random);
}

CubeRange Blocks::range_of(int block) const {
  CubeRange range = all_;
  int first = 0;
  descend([&](const Cut& cut) {
    const bool is_below = block < first + cut.blocks_below;
    (is_below ? range.high : range.low)[cut.axis] = cut.at;
    if (!is_below) first += cut.blocks_below;
    return is_below;
  });
  return range;
}

Blocks::Cut Blocks::drawn_cut(const Part& part, std::mt19937_64& random) {
  constexpr double kThinShare = 0.25;
  const auto draw = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto length = [&](std::size_t axis) { return part.cubes.length(axis); };
  const auto at = [&](std::size_t axis, int cubes_below) { return part.cubes.low[axis] + cubes_below; };
  std::size_t axis = static_cast<std::size_t>(draw(0, 2));
  for (int i = 0; i < 2 && length(axis) < 2; ++i) axis = (axis + 1) % 3;
  if (length(axis) < 2) return {axis, at(axis, length(axis)), part.num_blocks / 2};
  const int cut = std::bernoulli_distribution(kThinShare)(random) ? 1 : draw(1, length(axis) - 1);
  const int area = length((axis + 1) % 3) * length((axis + 2) % 3);
  const int least = std::max(1, part.num_blocks - area * (length(axis) - cut));
  const int most = std::min(part.num_blocks - 1, area * cut);
  return {axis, at(axis, cut), draw(std::min(least, most), most)};
}

}  // namespace podm
