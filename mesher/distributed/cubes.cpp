#include "distributed/cubes.h"

#include <algorithm>
#include <cmath>

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
  /// The range must include all cubes of the grid beside cubes of the set.
  StepsOut(const CubeSet& set, const CubeRange& range, std::uint8_t farthest)
      : set_(set),
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
    const CubeId first = set_.grid().id({range_.low[0], range_.low[1] + y, range_.low[2] + z});
    std::uint8_t* const here = row(y, z);
    for (std::size_t x = 1; x <= length_; ++x) {
      const std::uint8_t nearest = std::min(std::min(nearest_[x - 1], nearest_[x]), nearest_[x + 1]);
      const bool has = set_.has(first + static_cast<CubeId>(x - 1));
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
  const CubeRange range_;
  const std::uint8_t farthest_;
  const std::size_t length_, rows_;
  std::vector<std::uint8_t> steps_, nearest_;
};

// Returns the range with one more cube at the high end of each axis.
CubeRange one_longer(CubeRange range) {
  for (int& high : range.high) ++high;
  return range;
}

}  // namespace

CubeGrid::CubeGrid(const Box& box, double side_mm)
    : box_(box), origin_(box.low), side_mm_(side_mm), per_mm_(1 / side_mm) {
  const Vector extent = box.high - box.low;
  const auto along = [&](double length_mm) { return std::max(1.0, std::ceil(length_mm / side_mm)); };
  const std::array<double, 3> size{along(extent.x), along(extent.y), along(extent.z)};
  if (!(size[0] * size[1] * size[2] < CubeSet::kNone)) throw InputError("cells are too small for this image");
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

void CubeSet::insert_all() {
  has_.assign(has_.size(), 1);
  range_ = grid_->all();
}

bool CubeSet::is_full() const {
  return range_ == grid_->all() && std::find(has_.begin(), has_.end(), 0) == has_.end();
}

std::vector<CubeId> CubeSet::cubes() const {
  std::vector<CubeId> cubes;
  grid_->for_each(range_, [&](CubeId cube, const CubePlace&) {
    if (has(cube)) cubes.push_back(cube);
  });
  return cubes;
}

std::vector<std::array<CubeId, 2>> CubeSet::runs() const {
  std::vector<std::array<CubeId, 2>> runs;
  for (const CubeId cube : cubes()) {
    if (runs.empty() || runs.back()[1] + 1 != cube) runs.push_back({cube, cube});
    runs.back()[1] = cube;
  }
  return runs;
}

// Grows along one axis after another. Each cube thereby grows into a box around it.
CubeSet CubeSet::grown(int rings) const {
  CubeSet result = *this;
  if (range_.is_empty()) return result;
  const CubePlace& size = grid_->size();
  const std::array<std::ptrdiff_t, 3> stride{1, size[0], std::ptrdiff_t{size[0]} * size[1]};
  result.range_ = grid_->grown(range_, rings);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = result.has_;
    grid_->for_each(result.range_, [&](CubeId cube, const CubePlace& at) {
      if (before[cube] == 0) return;
      const int first = std::max(-rings, -at[axis]), last = std::min(rings, size[axis] - 1 - at[axis]);
      for (int step = first; step <= last; ++step) *(&result.has_[cube] + step * stride[axis]) = 1;
    });
  }
  return result;
}

CubeDepths::CubeDepths(const CubeSet& set, std::uint8_t most)
    : range_(set.grid().grown(set.range(), 1)), index_(range_) {
  if (set.range().is_empty()) {
    range_ = {};
  } else {
    depths_ = StepsOut(set, range_, static_cast<std::uint8_t>(most + 1)).depths();
  }
}

CubeCounts::CubeCounts(const CubeSet& set) : range_(set.range()), index_(one_longer(range_)) {
  if (range_.is_empty()) return;
  const auto size = [&](std::size_t axis) { return static_cast<std::size_t>(range_.length(axis)) + 1; };
  below_.assign(size(0) * size(1) * size(2), 0);
  const auto& [low, high] = range_;
  for (int z = low[2]; z < high[2]; ++z)
    for (int y = low[1]; y < high[1]; ++y) {
      std::uint32_t in_row = 0;
      for (int x = low[0]; x < high[0]; ++x) {
        in_row += set.has(set.grid().id({x, y, z}));
        below_[index_({x + 1, y + 1, z + 1})] =
            in_row + below(x + 1, y, z + 1) + below(x + 1, y + 1, z) - below(x + 1, y, z);
      }
    }
}

std::int64_t CubeCounts::count(CubePlace low, CubePlace high) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(low[axis], range_.low[axis]);
    high[axis] = std::min(high[axis] + 1, range_.high[axis]);
    if (low[axis] >= high[axis]) return 0;
  }
  const auto [a, b, c] = low;
  const auto [x, y, z] = high;
  return below(x, y, z) - below(a, y, z) - below(x, b, z) - below(x, y, c) + below(a, b, z) + below(a, y, c) +
         below(x, b, c) - below(a, b, c);
}

std::vector<std::uint32_t> CubeSet::components() const {
  std::vector<std::uint32_t> component(has_.size(), kNone);
  std::uint32_t next = 0;
  std::vector<CubeId> front;
  for (const CubeId first : cubes()) {
    if (component[first] != kNone) continue;
    component[first] = next;
    front.assign(1, first);
    while (!front.empty()) {
      const CubePlace at = grid_->place_of(front.back());
      front.pop_back();
      grid_->for_each(grid_->with_neighbors(at), [&](CubeId cube, const CubePlace&) {
        if (!has(cube) || component[cube] != kNone) return;
        component[cube] = next;
        front.push_back(cube);
      });
    }
    ++next;
  }
  return component;
}

}  // namespace podm
