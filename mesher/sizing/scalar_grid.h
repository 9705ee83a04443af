// Positive numbers at the nodes of a grid, and between them. A node may have no number.
//
// Between nodes the number is the mean over those of the eight surrounding nodes that have one, by their
// trilinear weights. The cells at the border extend half a cell beyond the nodes. The number there is that of
// the nearest place between nodes. Elsewhere there is no number, nor where none of the eight nodes has a
// number and a weight.
//
// Where some nodes have no number, the mean may jump between two cells. Within kSlack of a cell's side the
// number is the least of both sides. The same point computed with other rounding therefore gets no smaller
// number.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "geometry/affine.h"
#include "geometry/box.h"

namespace podm {

class ScalarGrid {
 public:
  using Values = std::shared_ptr<const std::vector<float>>;
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  /// `values`, x fastest, are finite; 0 where a node has no number. `to_nodes` maps points to node indices
  /// and is not singular.
  ScalarGrid(const std::array<int, 3>& size, const Affine& to_nodes, Values values);

  /// The number at p, or kNone.
  double at(const Point& p) const;
  /// The number at the place between nodes that is nearest to p along the axes of the grid.
  double at_nearest(const Point& p) const;

  struct Range {
    double least = kNone, most = 0;
  };
  /// The range of the numbers of all nodes that have a weight at a point of the box. It may include nodes
  /// near them.
  Range range_in(const Box& box) const;
  /// True if the grid, extended by half a cell, and the box have a point in common. May also be true for
  /// boxes that pass each other at an angle.
  bool meets(const Box& box) const;

  const std::array<int, 3>& size() const { return size_; }
  const Affine& to_nodes() const { return to_nodes_; }
  const std::vector<float>& values() const { return *values_; }
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * steps_[1] +
           static_cast<std::size_t>(k) * steps_[2];
  }

 private:
  static constexpr double kSlack = 1e-7;  // in cells

  // A cell, given by its first node, and a place in it, 0 to 1 along each axis. For a point beyond all nodes
  // it is the nearest place.
  struct Place {
    std::array<int, 3> cell;
    std::array<double, 3> fraction;
    std::array<bool, 3> is_beyond;
  };

  double between_nodes(const std::array<double, 3>& u) const;
  double mean(const Place& place) const;
  double least_around(const Place& place) const;
  std::array<std::array<double, 2>, 3> node_bounds(const Box& box) const;

  std::array<int, 3> size_;
  Affine to_nodes_;
  Values values_;
  std::array<std::size_t, 3> steps_;   // between nodes along the axes
  std::array<std::size_t, 3> across_;  // the same, but 0 along an axis of one node
};

}  // namespace podm
