#include "octree/balanced_cubes.h"

#include <algorithm>
#include <bit>

namespace podm {

namespace {

// A cube of side 2^level is named by its Morton code without the last 3 level bits.
class Splits {
 public:
  Splits(const GridPoint& size, const std::function<bool(const GridCube&)>& is_too_large)
      : size_(size),
        root_level_(static_cast<unsigned>(std::bit_width(*std::max_element(size.begin(), size.end()) - 1))),
        split_(root_level_ + 1) {
    std::vector<MortonCode> asked{0};
    for (unsigned level = root_level_; level > 0; --level) {
      for (const MortonCode code : asked)
        if (is_too_large(cube(code, level))) split_[level].push_back(code);
      asked.clear();
      for_each_child(level, [&](MortonCode child) { asked.push_back(child); });
    }
    balance();
  }

  std::vector<GridCube> cubes() const {
    if (split_[root_level_].empty()) return {cube(0, root_level_)};
    std::vector<std::pair<MortonCode, GridCube>> sorted;
    for (unsigned level = root_level_; level > 0; --level) {
      for_each_child(level, [&](MortonCode child) {
        const auto& split = split_[level - 1];
        if (std::binary_search(split.begin(), split.end(), child)) return;
        sorted.emplace_back(child << 3 * (level - 1), cube(child, level - 1));
      });
    }
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
  // Of the cubes that are split; those beyond the grid do not count.
  template <class Visit>
  void for_each_child(unsigned level, const Visit& visit) const {
    for (const MortonCode code : split_[level])
      for (MortonCode child = 8 * code; child < 8 * code + 8; ++child)
        if (is_inside(cube(child, level - 1))) visit(child);
  }

  // A split cube D has parts of half its side, so whatever touches D must not be larger than D: of each
  // neighbour of D's size, the cube around is split. One pass from the finest cubes up makes that true.
  // Enough, because an unsplit cube E that touches a part of D touches D, and if E were larger than D it
  // would be around a neighbour of D, hence split.
  void balance() {
    for (unsigned level = 1; level < root_level_; ++level) {
      std::vector<MortonCode>& parents = split_[level + 1];
      for (const MortonCode code : split_[level]) {
        const GridPoint p = morton_point(code);
        for (unsigned i = 0; i < 27; ++i) {  // an x of -1 wraps round and is found outside
          const GridPoint q{p[0] + i % 3 - 1, p[1] + i / 3 % 3 - 1, p[2] + i / 9 - 1};
          const bool is_in_root = std::max({q[0], q[1], q[2]}) < 1u << (root_level_ - level);
          if (is_in_root && is_inside(cube(morton_code(q), level))) parents.push_back(morton_code(q) >> 3);
        }
      }
      std::sort(parents.begin(), parents.end());
      parents.erase(std::unique(parents.begin(), parents.end()), parents.end());
    }
  }

  GridPoint size_;
  unsigned root_level_;
  std::vector<std::vector<MortonCode>> split_;  // by level, sorted
};

}  // namespace

std::vector<GridCube> balanced_cubes(const GridPoint& size,
                                     const std::function<bool(const GridCube&)>& is_too_large) {
  return Splits(size, is_too_large).cubes();
}

}  // namespace podm
