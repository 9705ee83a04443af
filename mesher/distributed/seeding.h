// A rank's first vertices: all seeds in and around its block, and few elsewhere (lattice_seeds.h).
#pragma once

#include <unordered_set>

#include "distributed/lattice_seeds.h"
#include "distributed/learner.h"
#include "distributed/vertex_source.h"
#include "geometry/point_hash.h"

namespace podm {

class Seeding : public VertexSource {
 public:
  /// Keeps the references. Inserts sparse seeds around the cubes of `block`.
  Seeding(const LatticeSeeds& seeds, Learner& learner, const CubeSet& block);

  std::uint64_t num_inserted() const { return num_inserted_; }
  CubeSet known() const override { return known_; }
  /// Inserts the seeds in those of these cubes that are not known yet.
  Update update(const CubeSet& wanted, std::vector<CellId>* made = nullptr) override;

 private:
  void learn(const std::vector<Point>& points, std::vector<CellId>* made);

  const LatticeSeeds& seeds_;
  Learner& learner_;
  CubeSet known_;
  std::uint64_t num_inserted_ = 0;
  std::unordered_set<Point, PointHash> sparse_;  // seeds of the constructor
};

/// Returns some of the vertices, the fewer the farther they are from the block: one of each group of cubes.
/// A group is one cube beside the block and in it, and has sides of up to its distance elsewhere.
std::vector<LearntVertex> sparse_around(const CubeRange& block, const CubeGrid& grid,
                                        const std::vector<LearntVertex>& vertices);

}  // namespace podm
