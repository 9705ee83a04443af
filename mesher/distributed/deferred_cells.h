// The cells that ranks defer, because their rules need vertices outside the zone, and the zones of the next
// round around these cells.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "delaunay/mesh.h"
#include "distributed/blocks.h"
#include "distributed/communication.h"
#include "distributed/zones_of_round.h"
#include "geometry/lens.h"

namespace podm {

/// A name of a cell that is the same on all ranks.
struct CellName {
  std::array<Point, 4> vertices;  ///< in lexicographic order
};

CellName name_of(const Mesh& mesh, CellId c);

/// Returns the circumscribed ball. `extent` is that of the mesh.
Ball circumscribed_ball(const CellName& name, double extent);

/// Returns an order along a space-filling curve, in which walks from each cell to the next are short.
std::vector<std::size_t> along_curve(const std::vector<CellName>& names, const CubeGrid& grid,
                                     std::size_t threads);

/// Zones, round by round: the blocks first, then zones around the cells that all ranks have deferred.
class ZonesInRounds {
 public:
  /// Keeps the references. `extent` is that of the mesh.
  ZonesInRounds(const CubeGrid& grid, const Blocks& blocks, double extent, std::size_t threads,
                Communication& ranks);

  const Zones& of_this_round() const { return zones_; }
  /// Collective. Divides space around the deferred cells of all ranks, at least one. Returns those of this
  /// rank's next zone. `round` is the number of the round that has deferred them.
  std::vector<CellName> plan_next(int round, const std::vector<CellName>& deferred, const Writers& writers);
  /// Returns the cubes whose vertices must be known before these deferred cells are refined in a zone:
  /// those around the zone, and more around large balls.
  CubeSet wanted(CubeSet around_zone, const std::vector<CellName>& names) const;

 private:
  struct Waiting;

  Ball ball_of(const CellName& name) const { return circumscribed_ball(name, extent_); }
  std::vector<Waiting> by_cube(const std::vector<CellName>& names) const;
  CubeSet share_waiting(const std::vector<CellName>& deferred, std::vector<CubeCount>* num_waiting);
  std::vector<std::vector<CellName>> by_rank(const std::vector<CellName>& deferred) const;
  void add_load(const std::vector<std::vector<CellName>>& by_rank);

  const CubeGrid& grid_;
  const Blocks& blocks_;
  const double extent_;
  const std::size_t threads_;
  Communication& ranks_;
  Zones zones_;
  double reach_over_radius_ = 1;     // the largest ball of a cube requests a zone within this many radii
  std::vector<std::uint64_t> load_;  // by rank: deferred cells assigned to it
};

}  // namespace podm
