#include "optimize/edge_removal.h"

#include <limits>

namespace podm {

// Returns the quality of the worse of the two cells over and under the triangle.
double EdgeRemoval::quality_of_triangle(unsigned i, unsigned k, unsigned j) const {
  const double over = quality_.of_new({points_[i], points_[k], points_[j], top_}, bound_);
  if (over <= floor_) return 0;
  const double under = quality_.of_new({points_[i], points_[j], points_[k], bottom_}, bound_);
  return under <= floor_ ? 0 : std::min(over, under);
}

// best_[i][j]: the quality of the part of the ring from i to j that the chord ij cuts off.
double EdgeRemoval::plan(const std::vector<Point>& points, const EdgeRing& ring, const LabelBound& bound,
                         double floor) {
  const unsigned n = ring.size;
  for (unsigned i = 0; i < n; ++i) points_[i] = points[ring.vertices[i]];
  bottom_ = points[ring.bottom];
  top_ = points[ring.top];
  bound_ = bound;
  floor_ = floor;
  for (unsigned i = 0; i + 1 < n; ++i) best_[i][i + 1] = std::numeric_limits<double>::infinity();
  for (unsigned length = 2; length < n; ++length) {
    for (unsigned i = 0; i + length < n; ++i) {
      const unsigned j = i + length;
      best_[i][j] = 0;
      for (unsigned k = i + 1; k < j; ++k) {
        const double parts = std::min(best_[i][k], best_[k][j]);
        if (parts <= best_[i][j]) continue;
        const double whole = std::min(parts, quality_of_triangle(i, k, j));
        if (whole <= best_[i][j]) continue;
        best_[i][j] = whole;
        apex_[i][j] = static_cast<std::uint8_t>(k);
      }
    }
  }
  return best_[0][n - 1];
}

void EdgeRemoval::list_cells(const EdgeRing& ring, std::vector<LocalCell>& cells) const {
  cells.clear();
  list_cells(ring, 0, ring.size - 1, cells);
}

void EdgeRemoval::list_cells(const EdgeRing& ring, unsigned i, unsigned j,
                             std::vector<LocalCell>& cells) const {
  if (j == i + 1) return;
  const unsigned k = apex_[i][j];
  const Local a = ring.vertices[i], b = ring.vertices[k], c = ring.vertices[j];
  cells.push_back({a, b, c, ring.top});
  cells.push_back({a, c, b, ring.bottom});
  list_cells(ring, i, k, cells);
  list_cells(ring, k, j, cells);
}

}  // namespace podm
