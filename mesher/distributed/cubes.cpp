#include "distributed/cubes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "podm/errors.h"

namespace podm {

namespace {

// Computes the distance of each cube of a range, in steps, to the nearest cube that is not in the set. A cube
// outside the set has distance 0; each cube of the set is one step farther than the nearest of its
// neighbours. Two passes, row by row forwards and backwards, read the neighbours that were visited already.
// (Rosenfeld and Pfaltz, J. ACM 13 (1966) 471-494.) A frame of cubes at distance `farthest` surrounds the
// rows; it stands for the space around the grid. Larger distances are cut to `farthest`.
class StepsOut {
 public:
  /// The range must include all cubes of the grid beside cubes of the set `within`.
  StepsOut(const CubeSet& set, const CubeRange& within, const CubeRange& range, std::uint8_t farthest)
      : set_(set),
        within_(within),
        range_(range),
        farthest_(farthest),
        length_(static_cast<std::size_t>(range.length(0))),
        rows_(static_cast<std::size_t>(range.length(1)) + 2),
        steps_((length_ + 2) * rows_ * (static_cast<std::size_t>(range.length(2)) + 2), farthest),
        nearest_(length_ + 2) {}

  /// Returns, by cube of the range, the number of steps less one for cubes of the set, and 0 for all others.
  std::vector<std::uint8_t> depths() {
    const int y_end = range_.length(1), z_end = range_.length(2);
    for (int z = 0; z < z_end; ++z)
      for (int y = 0; y < y_end; ++y) visit_row(y, z, 1);
    for (int z = z_end; z-- > 0;)
      for (int y = y_end; y-- > 0;) visit_row(y, z, -1);
    std::vector<std::uint8_t> depths;
    for (int z = 0; z < z_end; ++z)
      for (int y = 0; y < y_end; ++y)
        std::transform(row(y, z) + 1, row(y, z) + 1 + length_, std::back_inserter(depths),
                       [](std::uint8_t steps) { return static_cast<std::uint8_t>(std::max(0, steps - 1)); });
    return depths;
  }

 private:
  std::uint8_t* row(int y, int z) {
    return steps_.data() +
           (static_cast<std::size_t>(z + 1) * rows_ + static_cast<std::size_t>(y + 1)) * (length_ + 2);
  }

  void visit_row(int y, int z, int direction) {
    const std::array<const std::uint8_t*, 4> passed{row(y - direction, z), row(y - 1, z - direction),
                                                    row(y, z - direction), row(y + 1, z - direction)};
    for (std::size_t x = 0; x < length_ + 2; ++x)
      nearest_[x] = std::min(std::min(passed[0][x], passed[1][x]), std::min(passed[2][x], passed[3][x]));
    CubePlace at{range_.low[0], range_.low[1] + y, range_.low[2] + z};
    const CubeId first = set_.grid().id(at);
    std::uint8_t* const here = row(y, z);
    for (std::size_t x = 1; x <= length_; ++x, ++at[0]) {
      const std::uint8_t nearest = std::min(std::min(nearest_[x - 1], nearest_[x]), nearest_[x + 1]);
      const bool has = within_.has(at) && set_.has(first + static_cast<CubeId>(x - 1));
      here[x] = has ? std::min(here[x], farther(nearest)) : std::uint8_t{0};
    }
    for (std::size_t i = 1; i <= length_; ++i) {
      const std::size_t x = direction > 0 ? i : length_ + 1 - i;
      here[x] = std::min(here[x], farther(here[direction > 0 ? x - 1 : x + 1]));
    }
  }

  std::uint8_t farther(std::uint8_t steps) const {
    return static_cast<std::uint8_t>(std::min(steps + 1, int{farthest_}));
  }

  const CubeSet& set_;
  const CubeRange within_, range_;
  const std::uint8_t farthest_;
  const std::size_t length_, rows_;
  std::vector<std::uint8_t> steps_, nearest_;
};

CubeRange intersection(CubeRange a, const CubeRange& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    a.low[axis] = std::max(a.low[axis], b.low[axis]);
    a.high[axis] = std::min(a.high[axis], b.high[axis]);
  }
  return a;
}

}  // namespace

CubeGrid::CubeGrid(const Box& box, double side_mm)
    : box_(box), origin_(box.low), side_mm_(side_mm), per_mm_(1 / side_mm) {
  const Vector extent = box.high - box.low;
  const auto along = [&](double length_mm) { return std::max(1.0, std::ceil(length_mm / side_mm)); };
  const std::array<double, 3> size{along(extent.x), along(extent.y), along(extent.z)};
  if (!(size[0] * size[1] * size[2] < std::numeric_limits<CubeId>::max()))
    throw InputError("cells are too small for this image");
  for (std::size_t axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(size[axis]);
  num_cubes_ = static_cast<CubeId>(size[0] * size[1] * size[2]);
}

MortonCode CubeGrid::place_on_curve(const Point& p) const {
  constexpr double kPlacesPerSide = 16;  // places per side of a cube
  constexpr double kLast = (1u << kMortonBits) - 1;
  const Vector g = kPlacesPerSide * per_mm_ * (p - origin_);
  const auto along = [=](double x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0, kLast)); };
  return morton_code({along(g.x), along(g.y), along(g.z)});
}

CubePlace CubeGrid::place_of(CubeId cube) const {
  const auto x = static_cast<CubeId>(size_[0]), y = static_cast<CubeId>(size_[1]);
  return {static_cast<int>(cube % x), static_cast<int>(cube / x % y), static_cast<int>(cube / x / y)};
}

CubeRange CubeGrid::grown(const CubeRange& range, int rings) const {
  CubeRange grown;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grown.low[axis] = std::max(0, range.low[axis] - rings);
    grown.high[axis] = std::min(size_[axis], range.high[axis] + rings);
  }
  return grown;
}

template <class Visit>
bool CubeSet::for_each_word(CubeId first, CubeId last, const Visit& visit) {
  for (std::size_t word = word_of(first); word <= word_of(last); ++word) {
    Word bits = ~Word{0};
    if (word == word_of(first)) bits &= ~Word{0} << bit_of(first);
    if (word == word_of(last)) bits &= ~Word{0} >> (63 - bit_of(last));
    if (!visit(word, bits)) return false;
  }
  return true;
}

bool CubeSet::has_all(CubeId first, CubeId last) const {
  return for_each_word(first, last,
                       [&](std::size_t word, Word bits) { return (words_[word] & bits) == bits; });
}

bool CubeSet::has_any(CubeId first, CubeId last) const {
  return !for_each_word(first, last, [&](std::size_t word, Word bits) { return (words_[word] & bits) == 0; });
}

void CubeSet::insert_run(CubeId first, CubeId last) {
  for_each_word(first, last, [&](std::size_t word, Word bits) { return words_[word] |= bits, true; });
}

CubeId CubeSet::next(CubeId cube, CubeId end, bool is_in_set) const {
  while (cube < end) {
    const Word bits = (is_in_set ? words_[word_of(cube)] : ~words_[word_of(cube)]) >> bit_of(cube);
    if (bits != 0) return std::min(end, cube + static_cast<CubeId>(std::countr_zero(bits)));
    cube += 64 - bit_of(cube);
  }
  return end;
}

template <class Visit>
void CubeSet::for_each_run(const Visit& visit) const {
  if (range_.is_empty()) return;
  CubePlace at = range_.low;
  for (at[2] = range_.low[2]; at[2] < range_.high[2]; ++at[2])
    for (at[1] = range_.low[1]; at[1] < range_.high[1]; ++at[1]) {
      const CubeId row = grid_->id({0, at[1], at[2]});
      const CubeId end = row + static_cast<CubeId>(range_.high[0]);
      CubeId first = row + static_cast<CubeId>(range_.low[0]);
      while ((first = next(first, end, true)) < end) {
        const CubeId after = next(first, end, false);
        at[0] = static_cast<int>(first - row);
        visit(first, after - 1, std::as_const(at));
        first = after;
      }
    }
}

template <class Test>
bool CubeSet::all_rows(const CubeRange& range, const Test& test) const {
  for (int z = range.low[2]; z < range.high[2]; ++z)
    for (int y = range.low[1]; y < range.high[1]; ++y)
      if (!test(grid_->id({range.low[0], y, z}), grid_->id({range.high[0] - 1, y, z}))) return false;
  return true;
}

bool CubeSet::covers(const CubeRange& range) const {
  return all_rows(range, [&](CubeId first, CubeId last) { return has_all(first, last); });
}

bool CubeSet::meets(CubeRange range) const {
  range = intersection(range, range_);
  if (range.is_empty()) return false;
  return !all_rows(range, [&](CubeId first, CubeId last) { return !has_any(first, last); });
}

void CubeSet::insert(const CubeRange& range) {
  if (range.is_empty()) return;
  all_rows(range, [&](CubeId first, CubeId last) { return insert_run(first, last), true; });
  extend(range);
}

void CubeSet::insert(const CubeSet& cubes) {
  cubes.for_each_run([&](CubeId first, CubeId last, const CubePlace&) { insert_run(first, last); });
  extend(cubes.range_);
}

void CubeSet::insert(const CubeRun& run) {
  insert_run(run[0], run[1]);
  const CubePlace first = grid_->place_of(run[0]), last = grid_->place_of(run[1]);
  CubeRange range{first, {last[0] + 1, last[1] + 1, last[2] + 1}};
  const bool is_in_plane = first[2] == last[2], is_in_row = is_in_plane && first[1] == last[1];
  if (!is_in_row) range.low[0] = 0, range.high[0] = grid_->size()[0];
  if (!is_in_plane) range.low[1] = 0, range.high[1] = grid_->size()[1];
  extend(range);
}

bool CubeSet::covers(const Point& center, double radius_mm) const {
  bool is_covered = true;
  grid_->for_each_row(center, radius_mm,
                      [&](CubeId first, CubeId last) { return is_covered = has_all(first, last); });
  return is_covered;
}

void CubeSet::insert(const Point& center, double radius_mm) {
  grid_->for_each_row(center, radius_mm,
                      [&](CubeId first, CubeId last) { return insert_run(first, last), true; });
  const Vector reach{radius_mm, radius_mm, radius_mm};
  const CubePlace low = grid_->place_of(center - reach), last = grid_->place_of(center + reach);
  extend({low, {last[0] + 1, last[1] + 1, last[2] + 1}});
}

std::vector<CubeId> CubeSet::cubes() const {
  std::vector<CubeId> cubes;
  for_each_run([&](CubeId first, CubeId last, const CubePlace&) {
    for (CubeId cube = first; cube <= last; ++cube) cubes.push_back(cube);
  });
  return cubes;
}

std::vector<CubeRun> CubeSet::runs() const {
  std::vector<CubeRun> runs;
  for_each_run([&](CubeId first, CubeId last, const CubePlace&) {
    if (!runs.empty() && runs.back()[1] + 1 == first) {
      runs.back()[1] = last;
    } else {
      runs.push_back({first, last});
    }
  });
  return runs;
}

// Grows along one axis after another. Each cube thereby grows into a box around it.
CubeSet CubeSet::grown(int rings) const {
  CubeSet result = *this;
  if (range_.is_empty()) return result;
  const CubePlace& size = grid_->size();
  const std::array<std::ptrdiff_t, 3> stride{1, size[0], std::ptrdiff_t{size[0]} * size[1]};
  const auto moved = [&](CubeId cube, int steps, std::size_t axis) {
    return static_cast<CubeId>(cube + steps * stride[axis]);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const CubeSet before = result;
    before.for_each_run([&](CubeId first, CubeId last, const CubePlace& at) {
      const int length = axis == 0 ? static_cast<int>(last - first) + 1 : 1;
      const int down = -std::min(rings, at[axis]), up = std::min(rings, size[axis] - length - at[axis]);
      if (axis == 0) return result.insert_run(moved(first, down, 0), moved(last, up, 0));
      for (int steps = down; steps <= up; ++steps)
        result.insert_run(moved(first, steps, axis), moved(last, steps, axis));
    });
    result.range_.low[axis] = std::max(0, range_.low[axis] - rings);
    result.range_.high[axis] = std::min(size[axis], range_.high[axis] + rings);
  }
  return result;
}

CubeNumbers::CubeNumbers(CubeSet cubes) : cubes_(std::move(cubes)), before_(cubes_.words_.size() + 1) {
  for (std::size_t word = 0; word < cubes_.words_.size(); ++word)
    before_[word + 1] = before_[word] + static_cast<std::uint32_t>(std::popcount(cubes_.words_[word]));
}

CubeDepths::CubeDepths(const CubeSet& set, const CubeRange& within, std::uint8_t most)
    : range_(intersection(set.range(), within)), index_({}) {
  if (range_.is_empty()) {
    range_ = {};
    return;
  }
  const CubeRange inside = range_;
  range_ = set.grid().grown(inside, 1);
  index_ = CubeRangeIndex(range_);
  depths_ = StepsOut(set, inside, range_, static_cast<std::uint8_t>(most + 1)).depths();
}

std::vector<std::uint32_t> CubeSet::components() const {
  constexpr std::uint32_t kNone = 0xffffffffu;
  const CubeNumbers number_of(*this);
  std::vector<std::uint32_t> component(number_of.count(), kNone);
  std::uint32_t next = 0;
  std::vector<CubeId> front;
  for (const CubeId first : cubes()) {
    if (component[number_of[first]] != kNone) continue;
    component[number_of[first]] = next;
    front.assign(1, first);
    while (!front.empty()) {
      const CubePlace at = grid_->place_of(front.back());
      front.pop_back();
      grid_->for_each(grid_->with_neighbors(at), [&](CubeId cube, const CubePlace&) {
        if (!has(cube) || component[number_of[cube]] != kNone) return;
        component[number_of[cube]] = next;
        front.push_back(cube);
      });
    }
    ++next;
  }
  return component;
}

}  // namespace podm
