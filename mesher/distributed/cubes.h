// A grid of equal cubes that divides space among ranks. A cube has one writer at a time, and the writer knows
// all vertices in the cube. Points outside the grid belong to the nearest cube, so the cubes at the faces of
// the grid are unbounded.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "geometry/box.h"
#include "octree/morton.h"

namespace podm {

using CubeId = std::uint32_t;
using CubePlace = std::array<int, 3>;

/// Cubes from `low` up to but not including `high`.
struct CubeRange {
  CubePlace low, high;
  int length(std::size_t axis) const { return high[axis] - low[axis]; }
  bool is_empty() const { return length(0) <= 0 || length(1) <= 0 || length(2) <= 0; }
  bool has(const CubePlace& at) const {
    return low[0] <= at[0] && at[0] < high[0] && low[1] <= at[1] && at[1] < high[1] && low[2] <= at[2] &&
           at[2] < high[2];
  }
  bool operator==(const CubeRange&) const = default;
};

/// Indices of a table with a value per cube of a range. An empty range has no index.
class CubeRangeIndex {
 public:
  explicit CubeRangeIndex(const CubeRange& range)
      : low_(range.low), length_(range.length(0)), rows_(range.length(1)) {}
  std::size_t operator()(const CubePlace& at) const {
    return (static_cast<std::size_t>(at[2] - low_[2]) * static_cast<std::size_t>(rows_) +
            static_cast<std::size_t>(at[1] - low_[1])) *
               static_cast<std::size_t>(length_) +
           static_cast<std::size_t>(at[0] - low_[0]);
  }

 private:
  CubePlace low_;
  int length_, rows_;
};

class CubeGrid {
 public:
  /// Covers the box with the fewest cubes of the given side, mm. Throws InputError if the cubes outnumber the
  /// ids.
  CubeGrid(const Box& box, double side_mm);

  CubeId num_cubes() const { return num_cubes_; }
  /// Returns the box that it was made for.
  const Box& box() const { return box_; }
  const CubePlace& size() const { return size_; }
  CubeRange all() const { return {{0, 0, 0}, size_}; }
  /// Returns the range of a cube and all cubes that share a face, an edge or a corner with it.
  CubeRange with_neighbors(const CubePlace& at) const {
    return grown({at, {at[0] + 1, at[1] + 1, at[2] + 1}}, 1);
  }
  /// Returns a range with all cubes of the grid within `rings` cubes of it along each axis.
  CubeRange grown(const CubeRange& range, int rings) const;
  double side_mm() const { return side_mm_; }
  CubePlace place_of(const Point& p) const {
    return {along(0, p.x - origin_.x), along(1, p.y - origin_.y), along(2, p.z - origin_.z)};
  }
  CubeId id(const CubePlace& at) const {
    return static_cast<CubeId>((at[2] * std::int64_t{size_[1]} + at[1]) * size_[0] + at[0]);
  }
  CubePlace place_of(CubeId cube) const;
  CubeId cube_at(const Point& p) const { return id(place_of(p)); }
  /// Returns the low corner of a cube.
  Point low_of(const CubePlace& at) const {
    return origin_ + side_mm_ * Vector{1.0 * at[0], 1.0 * at[1], 1.0 * at[2]};
  }
  /// Returns the position along a space-filling curve that is finer than the cubes. Consecutive points on the
  /// curve are near each other.
  MortonCode place_on_curve(const Point& p) const;
  /// Returns the squared distance from a point to the cube, mm^2, up to rounding.
  double squared_distance(const CubePlace& at, const Point& p) const {
    const Vector offset = p - origin_;
    return squared_length({to_cube(at, 0, offset.x), to_cube(at, 1, offset.y), to_cube(at, 2, offset.z)});
  }
  /// Calls visit(cube, its place).
  template <class Visit>
  void for_each(const CubeRange& range, const Visit& visit) const;
  /// Returns, for each of the length + 1 planes across the axis, the weight of the range's cubes below the
  /// plane.
  template <class Weight>
  std::vector<std::uint64_t> weights_below(const CubeRange& range, std::size_t axis,
                                           const std::vector<Weight>& weight_of_cube) const;

 private:
  // Clamps grid coordinates as doubles, because points may be anywhere.
  int along(std::size_t axis, double offset_mm) const {
    const double g = offset_mm * per_mm_;
    return g <= 0 ? 0 : g >= size_[axis] ? size_[axis] - 1 : static_cast<int>(g);
  }
  double to_cube(const CubePlace& at, std::size_t axis, double offset_mm) const {
    const double low = at[axis] * side_mm_, high = low + side_mm_;
    if (offset_mm < low && at[axis] > 0) return low - offset_mm;
    if (offset_mm > high && at[axis] + 1 < size_[axis]) return offset_mm - high;
    return 0;
  }

  Box box_;
  Point origin_;
  double side_mm_, per_mm_;
  CubePlace size_;
  CubeId num_cubes_;
};

template <class Visit>
void CubeGrid::for_each(const CubeRange& range, const Visit& visit) const {
  CubePlace at;
  for (at[2] = range.low[2]; at[2] < range.high[2]; ++at[2])
    for (at[1] = range.low[1]; at[1] < range.high[1]; ++at[1])
      for (at[0] = range.low[0]; at[0] < range.high[0]; ++at[0]) visit(id(at), std::as_const(at));
}

template <class Weight>
std::vector<std::uint64_t> CubeGrid::weights_below(const CubeRange& range, std::size_t axis,
                                                   const std::vector<Weight>& weight_of_cube) const {
  std::vector<std::uint64_t> below(static_cast<std::size_t>(range.length(axis)) + 1);
  for_each(range, [&](CubeId cube, const CubePlace& at) {
    below[static_cast<std::size_t>(at[axis] - range.low[axis]) + 1] += weight_of_cube[cube];
  });
  std::partial_sum(below.begin(), below.end(), below.begin());
  return below;
}

/// A set of cubes of a grid, which must outlive the set. Its functions visit only the least range that holds
/// all cubes ever inserted.
class CubeSet {
 public:
  explicit CubeSet(const CubeGrid& grid)
      : grid_(&grid), has_(grid.num_cubes()), range_{grid.size(), {0, 0, 0}} {}
  const CubeGrid& grid() const { return *grid_; }
  /// A range that holds all cubes of the set; empty if no cube was ever inserted.
  const CubeRange& range() const { return range_; }
  bool has(CubeId cube) const { return has_[cube] != 0; }
  bool has(const Point& p) const { return has(grid_->cube_at(p)); }
  void insert(CubeId cube) { insert(cube, grid_->place_of(cube)); }
  void insert(const CubePlace& at) { insert(grid_->id(at), at); }
  void erase(CubeId cube) { has_[cube] = 0; }
  void insert_all();
  bool is_full() const;
  std::vector<CubeId> cubes() const;
  /// Returns the first and the last cube of each run of consecutive numbers, in order.
  std::vector<std::array<CubeId, 2>> runs() const;
  /// Returns the set with all cubes added that are within `rings` cubes of one of its cubes along each axis.
  CubeSet grown(int rings) const;
  /// Returns a component number per cube. Cubes of the set that share a face, an edge or a corner, directly
  /// or through other cubes of the set, get the same number. Numbers start at 0, in the order of first cubes.
  /// Cubes outside the set have kNone.
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> components() const;
  /// Returns true if the set holds all cubes that a ball meets. Tests the cubes one by one.
  bool covers(const Point& center, double radius_mm) const {
    bool is_covered = true;
    for_each_near(center, radius_mm, [&](const CubePlace& at) { return is_covered = has(grid_->id(at)); });
    return is_covered;
  }
  /// Adds all cubes that a ball meets.
  void insert(const Point& center, double radius_mm) {
    for_each_near(center, radius_mm, [&](const CubePlace& at) { return insert(at), true; });
  }

 private:
  void insert(CubeId cube, const CubePlace& at) {
    has_[cube] = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      range_.low[axis] = std::min(range_.low[axis], at[axis]);
      range_.high[axis] = std::max(range_.high[axis], at[axis] + 1);
    }
  }
  // Calls visit(place of a cube) until it returns false.
  template <class Visit>
  void for_each_near(const Point& center, double radius_mm, const Visit& visit) const;

  const CubeGrid* grid_;
  std::vector<std::uint8_t> has_;
  CubeRange range_;
};

/// The depths of cubes in a set.
class CubeDepths {
 public:
  /// `most`: the largest depth that is distinguished, at most 254.
  CubeDepths(const CubeSet& set, std::uint8_t most);
  /// Returns the number of rings of cubes around the cube that are in the set; 0 for cubes outside the set.
  std::uint8_t operator()(const CubePlace& at) const { return range_.has(at) ? depths_[index_(at)] : 0; }

 private:
  CubeRange range_;
  CubeRangeIndex index_;
  std::vector<std::uint8_t> depths_;
};

/// Prefix sums that count the cubes of a set in any box with eight reads. (Crow, SIGGRAPH 1984.)
class CubeCounts {
 public:
  explicit CubeCounts(const CubeSet& set);
  /// covers() returns true if the set holds all cubes from `low` to `high`, meets() if it holds any of them.
  bool covers(const CubePlace& low, const CubePlace& high) const {
    return count(low, high) ==
           std::int64_t{high[0] - low[0] + 1} * (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
  }
  bool meets(const CubePlace& low, const CubePlace& high) const { return count(low, high) > 0; }

 private:
  std::int64_t count(CubePlace low, CubePlace high) const;
  std::uint32_t below(int x, int y, int z) const { return below_[index_({x, y, z})]; }

  CubeRange range_;
  CubeRangeIndex index_;              // of the range with one more cube along each axis
  std::vector<std::uint32_t> below_;  // number of cubes of the set whose coordinates are all less
};

template <class Visit>
void CubeSet::for_each_near(const Point& center, double radius_mm, const Visit& visit) const {
  const Vector reach{radius_mm, radius_mm, radius_mm};
  const CubePlace from = grid_->place_of(center - reach), to = grid_->place_of(center + reach);
  CubePlace at;
  for (at[2] = from[2]; at[2] <= to[2]; ++at[2])
    for (at[1] = from[1]; at[1] <= to[1]; ++at[1])
      for (at[0] = from[0]; at[0] <= to[0]; ++at[0])
        if (grid_->squared_distance(at, center) <= radius_mm * radius_mm && !visit(std::as_const(at))) return;
}

}  // namespace podm
