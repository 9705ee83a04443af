// Random octrees by seed: uniform and graded, of cubes, slabs and needles, with and without gaps.
#pragma once

#include <cmath>
#include <random>

#include "octree/octree.h"

namespace podm::test {

inline constexpr int kNumSeeds = 60;

struct RandomOctree {
  explicit RandomOctree(std::uint64_t seed) : random(seed) {
    const double extents[] = {0, 0.5, 1, 3, 4, 7.25, 9.5};
    const auto extent = [&] { return side_mm * extents[random() % std::size(extents)]; };
    low = {uniform(-50, 50), uniform(-50, 50), uniform(-50, 50)};
    high = low + Vector{extent(), extent(), extent()};
    is_graded = seed % 3 != 0;
    fine_point = {uniform(low.x, high.x), uniform(low.y, high.y), uniform(low.z, high.z)};
    grading = uniform(0.2, 4);
    gap_center = {uniform(low.x, high.x), uniform(low.y, high.y), uniform(low.z, high.z)};
    gap_radius = seed % 2 == 0 ? 0 : side_mm * uniform(0.5, 4);
  }

  double uniform(double from, double to) { return std::uniform_real_distribution(from, to)(random); }
  double finest_side_mm() const { return is_graded ? side_mm / 4 : side_mm; }
  // Grows with the distance of the cube from the fine point, up to the side of a leaf.
  double largest_side(const Point& from, const Point& to) const {
    if (!is_graded) return side_mm;
    const auto gap = [](double x, double a, double b) { return std::max({0.0, a - x, x - b}); };
    const Vector d{gap(fine_point.x, from.x, to.x), gap(fine_point.y, from.y, to.y),
                   gap(fine_point.z, from.z, to.z)};
    return grading * std::sqrt(squared_length(d));
  }
  bool is_needed(const Point& from, const Point& to) const {
    return distance(0.5 * (from + to), gap_center) >= gap_radius;
  }
  Octree whole() const {
    return make([](const Point&, const Point&) { return true; });
  }
  Octree pruned() const {
    return make([this](const Point& from, const Point& to) { return is_needed(from, to); });
  }
  Octree make(const Octree::IsNeeded& is_leaf) const {
    return {low, high, finest_side_mm(),
            [this](const Point& a, const Point& b) { return largest_side(a, b); }, is_leaf};
  }
  // Returns a point in the box or around it. Every third coordinate is on a face of a cube, as exactly as
  // rounding permits.
  Point point() {
    const auto coordinate = [&](double from, double to) {
      const double x = uniform(from - side_mm, to + side_mm);
      return random() % 3 != 0 ? x : from + finest_side_mm() * std::round((x - from) / finest_side_mm());
    };
    return {coordinate(low.x, high.x), coordinate(low.y, high.y), coordinate(low.z, high.z)};
  }

  std::mt19937_64 random;
  double side_mm = 3.7;
  Point low, high, fine_point, gap_center;
  bool is_graded;
  double grading, gap_radius;
};

inline std::vector<GridCube> cubes_of(const Octree& octree) {
  std::vector<GridCube> cubes;
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) cubes.push_back(octree.cube(leaf));
  return cubes;
}

/// Returns the cube's low corner, moved by `steps` of the finest side along each axis.
inline Point corner_mm(const Octree& octree, const GridCube& cube, std::uint32_t steps) {
  const auto x = [&](unsigned axis) { return static_cast<double>(cube.corner[axis] + steps); };
  return octree.origin() + octree.finest_side_mm() * Vector{x(0), x(1), x(2)};
}

/// True if the regions share a cube. `whole` is the same octree without gaps.
inline bool is_within_two_rings(const std::vector<GridCube>& whole, const GridCube& a, const GridCube& b) {
  return std::any_of(whole.begin(), whole.end(),
                     [&](const GridCube& cube) { return touch(cube, a) && touch(cube, b); });
}

}  // namespace podm::test
