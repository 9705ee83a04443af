// Positions along an arc, by length.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/point.h"
#include "lines/line_network.h"

namespace podm {

/// An arc with its lengths. A position is the length in mm from the arc's first point. Positions of a closed
/// arc repeat after its length.
class Arc {
 public:
  /// Keeps a reference to `arc`, which must have at least two points.
  explicit Arc(const LineArc& arc);

  double length() const { return lengths_.back(); }
  bool is_closed() const { return arc_->is_closed(); }

  /// The point at a position. Positions beyond the ends of an open arc give the ends themselves, to the bit.
  Point point_at(double position) const;
  /// The unit vector along the arc at a position, towards greater positions.
  Vector direction_at(double position) const;
  /// The position of the arc's point that is nearest to p; the least one if several are.
  double nearest_position(const Point& p) const;
  /// The length from one position to the next, forwards; a closed arc may pass its first point.
  double length_between(double from, double to) const;
  /// The position halfway.
  double middle(double from, double to) const { return wrapped(from + 0.5 * length_between(from, to)); }
  /// The greatest distance of the arc between two positions from the chord that joins them. `from` must not
  /// exceed `to` unless the arc is closed.
  double chord_deviation(double from, double to) const;

 private:
  double wrapped(double position) const;
  std::size_t segment_at(double position) const;

  const LineArc* arc_;
  std::vector<double> lengths_;  // by point, from the first one
};

}  // namespace podm
