// Edge removal: the cells around an edge are replaced by those over and under a triangulation of the ring
// of vertices around it, the one whose worst cell is best; by dynamic programming (Klincsek, "Minimal
// triangulations of polygonal domains", 1980; Freitag and Ollivier-Gooch, IJNME 40 (1997)).
#pragma once

#include <array>
#include <vector>

#include "optimize/cavity.h"

namespace podm {

/// The cells around an edge: (bottom, top, ring[i], ring[i + 1]) is positive, the last i + 1 is 0. Seen from
/// the top the ring turns counter-clockwise.
struct EdgeRing {
  static constexpr unsigned kMax = 9;  // beyond, there is hardly ever a way
  Local bottom = 0, top = 0;
  unsigned size = 0;
  std::array<Local, kMax> vertices{};
};

class EdgeRemoval {
 public:
  explicit EdgeRemoval(const CellQuality& quality) : quality_(quality) {}

  /// Finds the triangulation whose worst cell is best: returns its quality, 0 if all have cells that break a
  /// bound or are no better than `floor`. `bound` is that of the new cells.
  double plan(const std::vector<Point>& points, const EdgeRing& ring, const LabelBound& bound, double floor);
  /// The cells of the plan, of that ring.
  void list_cells(const EdgeRing& ring, std::vector<LocalCell>& cells) const;

 private:
  double quality_of_triangle(unsigned i, unsigned k, unsigned j) const;
  void list_cells(const EdgeRing& ring, unsigned i, unsigned j, std::vector<LocalCell>& cells) const;

  const CellQuality& quality_;
  std::array<Point, EdgeRing::kMax> points_{};
  Point bottom_, top_;
  LabelBound bound_;
  double floor_ = 0;
  std::array<std::array<double, EdgeRing::kMax>, EdgeRing::kMax> best_{};
  std::array<std::array<std::uint8_t, EdgeRing::kMax>, EdgeRing::kMax> apex_{};
};

}  // namespace podm
