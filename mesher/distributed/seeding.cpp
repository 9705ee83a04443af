#include "distributed/seeding.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <set>
#include <utility>

namespace podm {

namespace {

Box box_around(const CubeSet& cubes) {
  const CubeGrid& grid = cubes.grid();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (cubes.range().is_empty())
    return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  return {grid.low_of(cubes.range().low), grid.low_of(cubes.range().high)};
}

}  // namespace

Seeding::Seeding(const LatticeSeeds& seeds, Learner& learner, const CubeSet& block)
    : seeds_(seeds), learner_(learner), known_(block.grid()) {
  const std::vector<Point> sparse = seeds.sparse_around(box_around(block));
  sparse_.insert(sparse.begin(), sparse.end());
  learn(sparse, nullptr);
}

Update Seeding::update(const CubeSet& wanted, std::vector<CellId>* made) {
  Update update;
  CubeSet unknown(wanted.grid());
  for (const CubeId cube : wanted.cubes()) {
    if (known_.has(cube)) continue;
    unknown.insert(cube);
    known_.insert(cube);
    ++update.cubes;
  }
  if (update.cubes == 0) return update;
  std::vector<Point> points = seeds_.in(unknown);
  std::erase_if(points, [&](const Point& p) { return sparse_.contains(p); });
  update.inserted = points.size();
  learn(points, made);
  return update;
}

void Seeding::learn(const std::vector<Point>& points, std::vector<CellId>* made) {
  num_inserted_ += points.size();
  std::vector<LearntVertex> changes;
  for (const Point& p : points) changes.push_back({p, VertexKind::kCircumcenter});
  learner_.learn(changes, kSeed, made);
}

std::vector<LearntVertex> sparse_around(const CubeRange& block, const CubeGrid& grid,
                                        const std::vector<LearntVertex>& vertices) {
  std::set<std::pair<int, CubeId>> groups;  // the logarithm of the side, and the first cube
  std::vector<LearntVertex> some;
  for (const LearntVertex& vertex : vertices) {
    CubePlace at = grid.place_of(vertex.point);
    int rings = 1;  // from the block to the cube
    for (std::size_t axis = 0; axis < 3; ++axis)
      rings = std::max({rings, block.low[axis] - at[axis], at[axis] - block.high[axis] + 1});
    const int log_side = std::bit_width(static_cast<unsigned>(rings)) - 1;
    for (int& coordinate : at) coordinate = coordinate >> log_side << log_side;
    if (groups.emplace(log_side, grid.id(at)).second) some.push_back(vertex);
  }
  return some;
}

}  // namespace podm
