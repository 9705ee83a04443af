#include "distributed/cubes.h"

#include <algorithm>
#include <cmath>

#include "podm/errors.h"

namespace podm {

namespace {

// Computes the distance of each cube, in steps, to the nearest cube that is not in the set. A cube outside
// the set has distance 0; each cube of the set is one step farther than the nearest of its neighbours. Two
// passes, row by row forwards and backwards, read the neighbours that were visited already. (Rosenfeld and
// Pfaltz, J. ACM 13 (1966) 471-494.) A frame of cubes at distance `farthest` surrounds the rows. Larger
// distances are cut to `farthest`.
class StepsOut {
 public:
  StepsOut(const CubeGrid& grid, const std::vector<std::uint8_t>& has, std::uint8_t farthest)
      : grid_(grid),
        has_(has),
        farthest_(farthest),
        length_(static_cast<std::size_t>(grid.size()[0])),
        rows_(static_cast<std::size_t>(grid.size()[1]) + 2),
        steps_((length_ + 2) * rows_ * (static_cast<std::size_t>(grid.size()[2]) + 2), farthest),
        nearest_(length_ + 2) {}

  /// Returns, by cube, the number of steps less one for cubes of the set, and 0 for all others.
  std::vector<std::uint8_t> depths() {
    const auto [x, y_end, z_end] = grid_.size();
    for (int z = 0; z < z_end; ++z)
      for (int y = 0; y < y_end; ++y) visit_row(y, z, 1);
    for (int z = z_end; z-- > 0;)
      for (int y = y_end; y-- > 0;) visit_row(y, z, -1);
    std::vector<std::uint8_t> depths(has_.size());
    for (int z = 0; z < z_end; ++z)
      for (int y = 0; y < y_end; ++y)
        std::transform(row(y, z) + 1, row(y, z) + 1 + length_, depths.data() + grid_.id({0, y, z}),
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
    const std::uint8_t* const has = has_.data() + grid_.id({0, y, z});
    std::uint8_t* const here = row(y, z);
    for (std::size_t x = 1; x <= length_; ++x) {
      const std::uint8_t nearest = std::min(std::min(nearest_[x - 1], nearest_[x]), nearest_[x + 1]);
      here[x] = has[x - 1] == 0 ? std::uint8_t{0} : std::min(here[x], farther(nearest));
    }
    for (std::size_t i = 1; i <= length_; ++i) {
      const std::size_t x = direction > 0 ? i : length_ + 1 - i;
      here[x] = std::min(here[x], farther(here[direction > 0 ? x - 1 : x + 1]));
    }
  }

  std::uint8_t farther(std::uint8_t steps) const {
    return static_cast<std::uint8_t>(std::min(steps + 1, int{farthest_}));
  }

  const CubeGrid& grid_;
  const std::vector<std::uint8_t>& has_;
  const std::uint8_t farthest_;
  const std::size_t length_, rows_;
  std::vector<std::uint8_t> steps_, nearest_;
};

}  // namespace

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

CubeRange CubeGrid::with_neighbors(const CubePlace& at) const {
  CubeRange range;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    range.low[axis] = std::max(0, at[axis] - 1);
    range.high[axis] = std::min(size_[axis], at[axis] + 2);
  }
  return range;
}

bool CubeSet::is_full() const { return std::find(has_.begin(), has_.end(), 0) == has_.end(); }

std::vector<CubeId> CubeSet::cubes() const {
  std::vector<CubeId> cubes;
  for (CubeId cube = 0; cube < has_.size(); ++cube)
    if (has(cube)) cubes.push_back(cube);
  return cubes;
}

// Grows along one axis after another. Each cube thereby grows into a box around it.
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

std::vector<std::uint8_t> CubeSet::depths(std::uint8_t most) const {
  return StepsOut(*grid_, has_, static_cast<std::uint8_t>(most + 1)).depths();
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

std::int64_t CubeCounts::count(const CubePlace& low, const CubePlace& high) const {
  const auto [a, b, c] = low;
  const int x = high[0] + 1, y = high[1] + 1, z = high[2] + 1;
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
