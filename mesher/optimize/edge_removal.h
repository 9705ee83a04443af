// Edge removal: replaces the cells around an edge by the cells over and under a triangulation of the ring of
// vertices around it. Dynamic programming finds the triangulation whose worst cell is best (Klincsek,
// "Minimal triangulations of polygonal domains", 1980; Freitag and Ollivier-Gooch, IJNME 40 (1997)).
#pragma once

#include <array>
#include <vector>

#include "optimize/cavity.h"

namespace podm {

/// The cells around an edge: (bottom, top, ring[i], ring[i + 1]) is positive, the last i + 1 is 0. Seen from
/// the top the ring is counter-clockwise.
struct EdgeRing {
  static constexpr unsigned kMax = 9;  // larger rings hardly ever have a solution
  Local bottom = 0, top = 0;
  unsigned size = 0;
  std::array<Local, kMax> vertices{};
};

class EdgeRemoval {
 public:
  explicit EdgeRemoval(const OptimizationQuality& quality) : quality_(quality) {}

  /// Finds the triangulation whose worst cell is best. Returns its quality, or 0 if each triangulation has a
  /// cell that violates a bound or is no better than `floor`. `bound` is that of the new cells.
  double plan(const std::vector<Point>& points, const EdgeRing& ring, const LabelBound& bound, double floor);
  /// Lists the cells of the plan for that ring.
  void list_cells(const EdgeRing& ring, std::vector<LocalCell>& cells) const;

 private:
  double quality_of_triangle(unsigned i, unsigned k, unsigned j) const;
  void list_cells(const EdgeRing& ring, unsigned i, unsigned j, std::vector<LocalCell>& cells) const;

  const OptimizationQuality& quality_;
  std::array<Point, EdgeRing::kMax> points_{};
  Point bottom_, top_;
  LabelBound bound_;
  double floor_ = 0;
  std::array<std::array<double, EdgeRing::kMax>, EdgeRing::kMax> best_{};
  std::array<std::array<std::uint8_t, EdgeRing::kMax>, EdgeRing::kMax> apex_{};
};

}  // namespace podm
