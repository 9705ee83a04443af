#include "octree/balanced_cubes.h"

#include <algorithm>
#include <bit>

namespace podm {

namespace {

// A cube of side 2^level is identified by its Morton code without the last 3 * level bits.
class Splits {
 public:
  Splits(const GridPoint& size, const std::function<bool(const GridCube&)>& is_too_large,
         const std::stop_token& stop)
      : size_(size),
        stop_(stop),
        root_level_(static_cast<unsigned>(std::bit_width(*std::max_element(size.begin(), size.end()) - 1))),
        split_(root_level_ + 1) {
    std::vector<MortonCode> asked{0};
    for (unsigned level = root_level_; level > 0; --level) {
      for (const MortonCode code : asked)
        if (!stop_.stop_requested() && is_too_large(cube(code, level))) split_[level].push_back(code);
      asked.clear();
      for_each_child(level, [&](MortonCode child) { asked.push_back(child); });
    }
    balance();
  }

  std::vector<GridCube> cubes() const {
    const std::vector<GridCube> whole{cube(0, root_level_)};
    if (split_[root_level_].empty()) return whole;
    std::vector<std::pair<MortonCode, GridCube>> sorted;
    for (unsigned level = root_level_; level > 0; --level) {
      for_each_child(level, [&](MortonCode child) {
        const auto& split = split_[level - 1];
        if (std::binary_search(split.begin(), split.end(), child)) return;
        sorted.emplace_back(child << 3 * (level - 1), cube(child, level - 1));
      });
    }
    if (stop_.stop_requested()) return whole;  // some cubes may be missing
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<GridCube> cubes;
    for (const auto& [code, cube] : sorted) cubes.push_back(cube);
    return cubes;
  }

 private:
  static GridCube cube(MortonCode code, unsigned level) {
    GridCube cube{morton_point(code), 1u << level};
    for (auto& x : cube.corner) x <<= level;
    return cube;
  }
  bool is_inside(const GridCube& cube) const {
    return cube.corner[0] < size_[0] && cube.corner[1] < size_[1] && cube.corner[2] < size_[2];
  }
  // Visits the parts of the cubes that are split, except parts beyond the grid. After a stop request some are
  // missing.
  template <class Visit>
  void for_each_child(unsigned level, const Visit& visit) const {
    for (const MortonCode code : split_[level]) {
      if (stop_.stop_requested()) return;
      for (MortonCode child = 8 * code; child < 8 * code + 8; ++child)
        if (is_inside(cube(child, level - 1))) visit(child);
    }
  }

  // A split cube D has parts of half its side, so no larger cube than D may touch D. Therefore, for each
  // neighbour of D's size, the cube of twice the side around the neighbour is split. One pass from the finest
  // cubes up achieves that. It is enough, because an unsplit cube E that touches a part of D touches D, and
  // if E were larger than D, it would contain a neighbour of D and would therefore be split. D and its
  // neighbours have eight such cubes around them: along each axis D's own, or that of the one neighbour
  // outside D's own.
  void balance() {
    for (unsigned level = 1; level < root_level_; ++level) {
      std::vector<MortonCode>& parents = split_[level + 1];
      for (const MortonCode code : split_[level]) {
        if (stop_.stop_requested()) return;
        const GridPoint p = morton_point(code);
        for (unsigned i = 0; i < 8; ++i) {  // an x of -1 wraps round and is found to be outside
          const auto across = [&](unsigned axis) { return p[axis] + (p[axis] % 2 == 1 ? 1u : ~0u); };
          const auto along = [&](unsigned axis) { return (i >> axis & 1u) != 0 ? across(axis) : p[axis]; };
          const GridPoint q{along(0), along(1), along(2)};
          const bool is_in_root = std::max({q[0], q[1], q[2]}) < 1u << (root_level_ - level);
          if (is_in_root && is_inside(cube(morton_code(q), level))) parents.push_back(morton_code(q) >> 3);
        }
      }
      std::sort(parents.begin(), parents.end());
      parents.erase(std::unique(parents.begin(), parents.end()), parents.end());
    }
  }

  GridPoint size_;
  const std::stop_token& stop_;
  unsigned root_level_;
  std::vector<std::vector<MortonCode>> split_;  // the split cubes of each level, sorted
};

}  // namespace

std::vector<GridCube> balanced_cubes(const GridPoint& size,
                                     const std::function<bool(const GridCube&)>& is_too_large,
                                     const std::stop_token& stop) {
  return Splits(size, is_too_large, stop).cubes();
}

}  // namespace podm
