#include "octree/octree.h"

#include <fmt/format.h>

#include <cmath>

#include "podm/errors.h"

namespace podm {

namespace {

constexpr unsigned kMaxCellsAlongAxis = 1u << 20;
constexpr std::size_t kMaxBlocks = 1u << 21;  // 16 MiB

void sort_and_unify(std::vector<std::uint32_t>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

Octree::Octree(const Point& low, const Point& high, double finest_side_mm, const LargestSide& largest_side,
               const IsNeeded& is_needed, const std::stop_token& stop)
    : origin_(low), finest_side_mm_(finest_side_mm), inverse_side_(1 / finest_side_mm) {
  set_grid(low, high);
  const auto is_too_large = [&](const GridCube& cube) {
    return cube.side * finest_side_mm_ > largest_side(to_mm(cube, 0), to_mm(cube, cube.side));
  };
  cubes_ = balanced_cubes(size_, is_too_large, stop);
  is_uniform_ = std::all_of(cubes_.begin(), cubes_.end(),
                            [&](const GridCube& cube) { return cube.side == cubes_.front().side; });
  leaf_of_cube_.assign(cubes_.size(), kNoLeaf);
  for (CubeId id = 0; id < cubes_.size() && !stop.stop_requested(); ++id) {
    if (!is_needed(to_mm(cubes_[id], 0), to_mm(cubes_[id], cubes_[id].side))) continue;
    leaf_of_cube_[id] = num_leaves();
    cube_of_leaf_.push_back(id);
  }
  set_blocks();
}

void Octree::set_grid(const Point& low, const Point& high) {
  const Vector extent = high - low;
  const auto cells_along = [&](double length) {
    const double n = std::max(1.0, std::ceil(length * inverse_side_));
    if (!(finest_side_mm_ > 0 && length >= 0 && n <= kMaxCellsAlongAxis))
      throw InputError(fmt::format("no octree with leaves of {} mm in a box of {} x {} x {} mm",
                                   finest_side_mm_, extent.x, extent.y, extent.z));
    return static_cast<std::uint32_t>(n);
  };
  size_ = {cells_along(extent.x), cells_along(extent.y), cells_along(extent.z)};
}

// Returns the point that lies `steps` along each axis from the cube's corner.
Point Octree::to_mm(const GridCube& cube, std::uint32_t steps) const {
  const auto coordinate = [&](unsigned axis) { return static_cast<double>(cube.corner[axis] + steps); };
  return origin_ + finest_side_mm_ * Vector{coordinate(0), coordinate(1), coordinate(2)};
}

void Octree::set_blocks() {
  const auto along = [&](unsigned axis) { return ((size_[axis] - 1) >> block_shift_) + 1; };
  const auto count = [&] { return std::size_t{along(0)} * along(1) * along(2); };
  while (count() > kMaxBlocks) ++block_shift_;
  num_blocks_ = {along(0), along(1), along(2)};
  blocks_.resize(count());
  for (CubeId id = 0; id < cubes_.size(); ++id) {
    const auto& [corner, side] = cubes_[id];
    GridPoint end;  // one past the cube's last cell in the grid
    for (unsigned axis = 0; axis < 3; ++axis) end[axis] = std::min(corner[axis] + side, size_[axis]);
    const std::uint32_t step = 1u << block_shift_;
    for (std::uint32_t z = corner[2]; z < end[2]; z += step)
      for (std::uint32_t y = corner[1]; y < end[1]; y += step)
        for (std::uint32_t x = corner[0]; x < end[0]; x += step) {
          Block& block = blocks_[block_at({x, y, z})];
          if (block.count++ == 0) block.first = id;
        }
  }
}

Octree::CubeId Octree::search(const Block& block, const GridPoint& cell) const {
  const auto begin = cubes_.begin() + block.first;
  const auto after =
      std::upper_bound(begin, begin + block.count, morton_code(cell),
                       [](MortonCode code, const GridCube& cube) { return code < morton_code(cube.corner); });
  return static_cast<CubeId>(after - cubes_.begin()) - 1;
}

// Returns the cubes that contain the grid cells at every `step` of the cube and of the margin around it.
std::vector<Octree::CubeId> Octree::cubes_around(const GridCube& cube, std::uint32_t margin,
                                                 std::uint32_t step) const {
  const std::uint32_t num_steps = (cube.side + 2 * margin) / step;
  std::vector<CubeId> found;
  for (std::uint32_t i = 0; i < num_steps * num_steps * num_steps; ++i) {
    const GridPoint cell{cube.corner[0] - margin + i % num_steps * step,  // a value below 0 wraps round
                         cube.corner[1] - margin + i / num_steps % num_steps * step,
                         cube.corner[2] - margin + i / num_steps / num_steps * step};
    if (cell[0] < size_[0] && cell[1] < size_[1] && cell[2] < size_[2]) found.push_back(cube_at(cell));
  }
  sort_and_unify(found);
  return found;
}

// A neighbour's side is at least half the cube's.
std::vector<Octree::CubeId> Octree::touching(CubeId id) const {
  const std::uint32_t side = cubes_[id].side, least_side = is_uniform_ ? side : std::max(1u, side / 2);
  return cubes_around(cubes_[id], least_side, least_side);
}

std::vector<Octree::CubeId> Octree::touching_region_of(CubeId id) const {
  if (is_uniform_) return cubes_around(cubes_[id], 2 * cubes_[id].side, cubes_[id].side);
  std::vector<CubeId> found;
  for (const CubeId part : touching(id)) {
    const std::vector<CubeId> of_part = touching(part);
    found.insert(found.end(), of_part.begin(), of_part.end());
  }
  sort_and_unify(found);
  return found;
}

std::vector<GridCube> Octree::region(LeafId leaf) const {
  std::vector<GridCube> region;
  for (const CubeId id : touching(cube_of_leaf_[leaf])) region.push_back(cubes_[id]);
  return region;
}

std::vector<LeafId> Octree::first_ring(LeafId leaf) const {
  std::vector<LeafId> ring;
  for (const CubeId id : touching(cube_of_leaf_[leaf]))
    if (leaf_of_cube_[id] != kNoLeaf && leaf_of_cube_[id] != leaf) ring.push_back(leaf_of_cube_[id]);
  return ring;
}

std::vector<LeafId> Octree::second_ring(LeafId leaf) const {
  std::vector<LeafId> ring;
  for (const CubeId id : touching_region_of(cube_of_leaf_[leaf]))
    if (leaf_of_cube_[id] != kNoLeaf && !touch(cubes_[id], cube(leaf))) ring.push_back(leaf_of_cube_[id]);
  return ring;
}

}  // namespace podm
