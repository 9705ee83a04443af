#include "distributed/cubes.h"

#include <algorithm>
#include <cmath>

#include "podm/errors.h"

namespace podm {

CubeGrid::CubeGrid(const Box& box, double side_mm)
    : origin_(box.low), side_mm_(side_mm), per_mm_(1 / side_mm) {
  const Vector extent = box.high - box.low;
  const auto along = [&](double length_mm) { return std::max(1.0, std::ceil(length_mm / side_mm)); };
  const std::array<double, 3> size{along(extent.x), along(extent.y), along(extent.z)};
  if (!(size[0] * size[1] * size[2] < CubeSet::kNone)) throw InputError("cells are too small for this image");
  for (std::size_t axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(size[axis]);
  num_cubes_ = static_cast<CubeId>(size[0] * size[1] * size[2]);
}

MortonCode CubeGrid::place_on_curve(const Point& p) const {
  constexpr double kPlacesASide = 16;  // of a cube
  constexpr double kLast = (1u << kMortonBits) - 1;
  const Vector g = kPlacesASide * per_mm_ * (p - origin_);
  const auto along = [=](double x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0, kLast)); };
  return morton_code({along(g.x), along(g.y), along(g.z)});
}

CubePlace CubeGrid::place_of(CubeId cube) const {
  const auto x = static_cast<CubeId>(size_[0]), y = static_cast<CubeId>(size_[1]);
  return {static_cast<int>(cube % x), static_cast<int>(cube / x % y), static_cast<int>(cube / x / y)};
}

CubeRange CubeGrid::with_neighbors(const CubePlace& at) const {
  CubeRange range;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    range.low[axis] = std::max(0, at[axis] - 1);
    range.high[axis] = std::min(size_[axis], at[axis] + 2);
  }
  return range;
}

double CubeGrid::squared_distance(const CubePlace& at, const Point& p) const {
  const auto along = [&](std::size_t axis, double offset_mm) {
    const double low = at[axis] * side_mm_, high = low + side_mm_;
    if (offset_mm < low && at[axis] > 0) return low - offset_mm;
    if (offset_mm > high && at[axis] + 1 < size_[axis]) return offset_mm - high;
    return 0.0;
  };
  const Vector offset = p - origin_;
  return squared_length({along(0, offset.x), along(1, offset.y), along(2, offset.z)});
}

bool CubeSet::is_full() const { return std::find(has_.begin(), has_.end(), 0) == has_.end(); }

std::vector<CubeId> CubeSet::cubes() const {
  std::vector<CubeId> cubes;
  for (CubeId cube = 0; cube < has_.size(); ++cube)
    if (has(cube)) cubes.push_back(cube);
  return cubes;
}

// Along one axis after another: a cube then has each within a box around it.
CubeSet CubeSet::grown(int rings) const {
  CubeSet result = *this;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const CubeSet before = result;
    for (const CubeId cube : before.cubes()) {
      CubePlace at = grid_->place_of(cube);
      const int middle = at[axis], last = std::min(grid_->size()[axis] - 1, middle + rings);
      for (at[axis] = std::max(0, middle - rings); at[axis] <= last; ++at[axis]) result.insert(grid_->id(at));
    }
  }
  return result;
}

// A cube not in the set is 0 steps from one, and each is one step farther than the nearest of its neighbours.
// Two passes, along the ids and back, ask those that were passed already. (Rosenfeld and Pfaltz, J. ACM 13
// (1966) 471-494.)
std::vector<std::uint8_t> CubeSet::depths(std::uint8_t most) const {
  const CubePlace& size = grid_->size();
  std::vector<std::uint8_t> steps(has_.size());
  const auto visit = [&](CubePlace at, int direction) {
    const CubeId cube = grid_->id(at);
    if (!has(cube)) return;
    int least = direction > 0 ? most + 1 : steps[cube];
    for (int i = 0; i < 13; ++i) {  // the first of 27 in the order of ids
      const CubePlace beside{at[0] + direction * (i % 3 - 1), at[1] + direction * (i / 3 % 3 - 1),
                             at[2] + direction * (i / 9 - 1)};
      bool is_inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        is_inside = is_inside && beside[axis] >= 0 && beside[axis] < size[axis];
      if (is_inside) least = std::min(least, steps[grid_->id(beside)] + 1);
    }
    steps[cube] = static_cast<std::uint8_t>(least);
  };
  for (CubeId cube = 0; cube < grid_->num_cubes(); ++cube) visit(grid_->place_of(cube), 1);
  for (CubeId cube = grid_->num_cubes(); cube-- > 0;) visit(grid_->place_of(cube), -1);
  for (std::uint8_t& step : steps) step = static_cast<std::uint8_t>(std::max(0, step - 1));
  return steps;
}

CubeCounts::CubeCounts(const CubeSet& set) {
  const CubePlace& size = set.grid().size();
  sizes_ = {static_cast<std::size_t>(size[0]) + 1, static_cast<std::size_t>(size[1]) + 1};
  below_.assign(sizes_[0] * sizes_[1] * (static_cast<std::size_t>(size[2]) + 1), 0);
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y) {
      std::uint32_t in_row = 0;
      for (int x = 0; x < size[0]; ++x) {
        in_row += set.has(set.grid().id({x, y, z}));
        below(x + 1, y + 1, z + 1) =
            in_row + below(x + 1, y, z + 1) + below(x + 1, y + 1, z) - below(x + 1, y, z);
      }
    }
}

bool CubeCounts::covers(const CubePlace& low, const CubePlace& high) const {
  const auto [a, b, c] = low;
  const int x = high[0] + 1, y = high[1] + 1, z = high[2] + 1;
  const std::uint32_t count = below(x, y, z) - below(a, y, z) - below(x, b, z) - below(x, y, c) +
                              below(a, b, z) + below(a, y, c) + below(x, b, c) - below(a, b, c);
  return count == static_cast<std::uint32_t>(std::int64_t{x - a} * (y - b) * (z - c));
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
