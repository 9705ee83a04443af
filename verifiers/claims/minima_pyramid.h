// The least of numbers at the nodes of a grid that grow with the distance from their nodes.
#pragma once

#include <array>
#include <vector>

#include "mesh.h"

namespace podm::verify {

/// Minima over blocks of 2, 4, 8 .. nodes along each axis. A search skips a block if its minimum, grown over
/// the distance of the whole block, is not less than the least number found. Takes about 4.6 bytes per node.
class MinimaPyramid {
 public:
  /// `values`: x fastest; infinity where a node has none. `spacing`: between nodes. `slope`: growth per unit
  /// of length, positive.
  MinimaPyramid(const std::array<int, 3>& size, const std::array<double, 3>& spacing, double slope,
                std::vector<float> values);

  /// Returns the least number at a place, in nodes, if it is below `limit`; otherwise `limit`. A result below
  /// `enough` need not be the least.
  double least_at(const Point& place, double limit, double enough = 0) const;

 private:
  struct Level {
    std::array<int, 3> size;
    std::vector<float> minima;
  };
  using Block = std::array<int, 3>;

  static float minimum(const Level& level, const Block& block);
  static Level halved(const Level& level);
  double grown(std::size_t level, const Block& block, const Point& place) const;
  void lower(std::size_t level, const Block& block, const Point& place, double enough, double& least) const;

  std::array<double, 3> spacing_;
  double slope_;
  std::vector<Level> levels_;  // nodes first, one block last
};

}  // namespace podm::verify
