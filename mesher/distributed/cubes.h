// A grid of equal cubes that divides space among ranks. A cube has one writer at a time, and the writer knows
// all vertices in the cube. Points outside the grid belong to the nearest cube, so the cubes at the faces of
// the grid are unbounded.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/box.h"
#include "octree/morton.h"

namespace podm {

using CubeId = std::uint32_t;
using CubePlace = std::array<int, 3>;
using CubeRun = std::array<CubeId, 2>;  // the first and the last of consecutive numbers

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
  /// Calls visit(first cube, last cube) for each row of cubes along x that a ball meets, until it returns
  /// false.
  template <class Visit>
  void for_each_row(const Point& center, double radius_mm, const Visit& visit) const;
  /// Calls visit(cube, its place).
  template <class Visit>
  void for_each(const CubeRange& range, const Visit& visit) const;

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
void CubeGrid::for_each_row(const Point& center, double radius_mm, const Visit& visit) const {
  const Vector reach{radius_mm, radius_mm, radius_mm}, offset = center - origin_;
  const CubePlace from = place_of(center - reach), to = place_of(center + reach);
  CubePlace at = from;
  for (at[2] = from[2]; at[2] <= to[2]; ++at[2])
    for (at[1] = from[1]; at[1] <= to[1]; ++at[1]) {
      const double y = to_cube(at, 1, offset.y), z = to_cube(at, 2, offset.z);
      const double squared_half_mm2 = radius_mm * radius_mm - y * y - z * z;
      if (squared_half_mm2 < 0) continue;
      const double half_mm = std::sqrt(squared_half_mm2);
      const CubeId row = id({0, at[1], at[2]});
      if (!visit(row + static_cast<CubeId>(along(0, offset.x - half_mm)),
                 row + static_cast<CubeId>(along(0, offset.x + half_mm))))
        return;
    }
}

template <class Visit>
void CubeGrid::for_each(const CubeRange& range, const Visit& visit) const {
  CubePlace at;
  for (at[2] = range.low[2]; at[2] < range.high[2]; ++at[2])
    for (at[1] = range.low[1]; at[1] < range.high[1]; ++at[1])
      for (at[0] = range.low[0]; at[0] < range.high[0]; ++at[0]) visit(id(at), std::as_const(at));
}

/// A set of cubes of a grid, which must outlive the set: a bit per cube. Its functions visit only the least
/// range that holds all cubes ever inserted, and skip cubes that are not in the set by words of bits.
class CubeSet {
 public:
  explicit CubeSet(const CubeGrid& grid)
      : grid_(&grid), words_(word_of(grid.num_cubes()) + 1), range_{grid.size(), {0, 0, 0}} {}
  const CubeGrid& grid() const { return *grid_; }
  /// A range that holds all cubes of the set; empty if no cube was ever inserted.
  const CubeRange& range() const { return range_; }
  bool has(CubeId cube) const { return (words_[word_of(cube)] >> bit_of(cube) & 1u) != 0; }
  bool has(const Point& p) const { return has(grid_->cube_at(p)); }
  void insert(CubeId cube) { insert(grid_->place_of(cube)); }
  void insert(const CubePlace& at) {
    const CubeId cube = grid_->id(at);
    words_[word_of(cube)] |= Word{1} << bit_of(cube);
    extend({at, {at[0] + 1, at[1] + 1, at[2] + 1}});
  }
  void insert(const CubeRange& range);
  void insert(const CubeSet& cubes);
  void insert(const CubeRun& run);
  void erase(CubeId cube) { words_[word_of(cube)] &= ~(Word{1} << bit_of(cube)); }
  void insert_all() { insert(grid_->all()); }
  bool is_full() const { return covers(grid_->all()); }
  /// Returns the cubes in order.
  std::vector<CubeId> cubes() const;
  /// Returns the runs of consecutive numbers, in order.
  std::vector<CubeRun> runs() const;
  /// Returns the set with all cubes added that are within `rings` cubes of one of its cubes along each axis.
  CubeSet grown(int rings) const;
  /// Returns a component number for each of cubes(). Cubes that share a face, an edge or a corner, directly
  /// or through other cubes of the set, get the same number. Numbers start at 0, in the order of first cubes.
  std::vector<std::uint32_t> components() const;
  /// covers() returns true if the set holds all cubes of the range, meets() if it holds any of them.
  bool covers(const CubeRange& range) const;
  bool meets(CubeRange range) const;
  /// Returns true if the set holds all cubes that a ball meets.
  bool covers(const Point& center, double radius_mm) const;
  /// Adds all cubes that a ball meets.
  void insert(const Point& center, double radius_mm);

 private:
  friend class CubeNumbers;
  using Word = std::uint64_t;
  static constexpr std::size_t word_of(CubeId cube) { return cube / 64; }
  static constexpr unsigned bit_of(CubeId cube) { return cube % 64; }
  // Calls visit(word, its bits) for the words of the cubes from `first` to `last` until it returns false.
  // Returns false if a call did.
  template <class Visit>
  static bool for_each_word(CubeId first, CubeId last, const Visit& visit);
  bool has_all(CubeId first, CubeId last) const;
  bool has_any(CubeId first, CubeId last) const;
  void insert_run(CubeId first, CubeId last);
  // Returns the first cube from `cube` on that is in the set, or that is not, or `end`.
  CubeId next(CubeId cube, CubeId end, bool is_in_set) const;
  // Calls visit(first cube, last cube, place of the first) for the runs of each row, in order.
  template <class Visit>
  void for_each_run(const Visit& visit) const;
  // Calls test(first cube, last cube) for the rows of a range until it returns false. Returns false if a call
  // did.
  template <class Test>
  bool all_rows(const CubeRange& range, const Test& test) const;
  void extend(const CubeRange& range) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      range_.low[axis] = std::min(range_.low[axis], range.low[axis]);
      range_.high[axis] = std::max(range_.high[axis], range.high[axis]);
    }
  }

  const CubeGrid* grid_;
  std::vector<Word> words_;  // bits by cube
  CubeRange range_;
};

/// A set of cubes with consecutive numbers, in order.
class CubeNumbers {
 public:
  explicit CubeNumbers(CubeSet cubes);
  const CubeSet& cubes() const { return cubes_; }
  std::size_t count() const { return before_.back(); }
  /// The cube must be one of the set.
  std::size_t operator[](CubeId cube) const {
    const auto word = cubes_.words_[CubeSet::word_of(cube)];
    const auto below = word & ((CubeSet::Word{1} << CubeSet::bit_of(cube)) - 1);
    return before_[CubeSet::word_of(cube)] + static_cast<std::size_t>(std::popcount(below));
  }

 private:
  CubeSet cubes_;
  std::vector<std::uint32_t> before_;  // by word: the number of cubes in the words before
};

/// The depths of cubes in a set.
class CubeDepths {
 public:
  /// Cubes outside `within` count as outside the set. `most`: the largest depth that is distinguished, at
  /// most 254.
  CubeDepths(const CubeSet& set, const CubeRange& within, std::uint8_t most);
  /// Returns the number of rings of cubes around the cube that are in the set; 0 for cubes outside the set.
  std::uint8_t operator()(const CubePlace& at) const { return range_.has(at) ? depths_[index_(at)] : 0; }

 private:
  CubeRange range_;
  CubeRangeIndex index_;
  std::vector<std::uint8_t> depths_;
};

}  // namespace podm
