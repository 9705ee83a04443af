#include "distributed/predicted_work.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/leaf_size.h"
#include "prediction/cost_model.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

double work_of(const Problem& problem, LabelIndex label, const Point& p, double volume_mm3, double area_mm2) {
  const double radius_mm = std::sqrt(problem.sizes.squared_radius(label, p));
  return CostModel::cells(volume_mm3, area_mm2, radius_mm, problem.delta_mm) +
         kWorkPerSquare * area_mm2 / (problem.delta_mm * problem.delta_mm);
}

// The labels at eight points stand for the cube, a label change between two of them for a square of
// interface. There are twice as many pairs of neighbouring points as there are within cubes.
double work_in_cube(const Problem& problem, const Point& low, double side) {
  constexpr double kPairsOverPairsWithin = 2;
  const Point center = low + Vector{side / 2, side / 2, side / 2};
  const double reach = 0.87 * side;
  const LabelIndex label = problem.isosurface.label_at(center);
  if (problem.isosurface.distance_lower_bound(center, reach) > reach)
    return label == kBackground ? 0 : work_of(problem, label, center, side * side * side, 0);
  std::array<Point, 8> points;
  std::array<LabelIndex, 8> labels{};
  for (unsigned i = 0; i < 8; ++i) {
    points[i] = low + 0.25 * side * Vector{i & 1 ? 3.0 : 1.0, i & 2 ? 3.0 : 1.0, i & 4 ? 3.0 : 1.0};
    labels[i] = problem.isosurface.label_at(points[i]);
  }
  double work = 0;
  for (unsigned i = 0; i < 8; ++i) {
    if (labels[i] == kBackground) continue;
    const int changes =
        (labels[i] != labels[i ^ 1u]) + (labels[i] != labels[i ^ 2u]) + (labels[i] != labels[i ^ 4u]);
    const double square_mm2 = kPairsOverPairsWithin * side * side / 4;
    work += work_of(problem, labels[i], points[i], side * side * side / 8, changes * square_mm2);
  }
  return work;
}

}  // namespace

CubeWork predicted_work(const Problem& problem, const CubeGrid& grid, std::size_t threads,
                        const Communication& ranks) {
  constexpr double kParts = 1e3;
  constexpr std::size_t kLength = 256;
  const auto first_of = [&](int rank) {
    return static_cast<CubeId>(std::uint64_t{grid.num_cubes()} * static_cast<std::uint64_t>(rank) /
                               static_cast<std::uint64_t>(ranks.size()));
  };
  CubeWork own{first_of(ranks.rank()), {}};
  own.of_cube.resize(first_of(ranks.rank() + 1) - own.first);
  parallel_for_ranges(
      own.of_cube.size(), kLength, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
          const Point low = grid.low_of(grid.place_of(own.first + static_cast<CubeId>(i)));
          own.of_cube[i] =
              static_cast<std::uint32_t>(std::min(4e9, kParts * work_in_cube(problem, low, grid.side_mm())));
        }
      });
  return own;
}

}  // namespace podm
