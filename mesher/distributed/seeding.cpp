#include "distributed/seeding.h"

#include <limits>

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

}  // namespace podm
