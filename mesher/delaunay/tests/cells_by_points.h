// Test helper: compares triangulations without regard to ids.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "delaunay/mesh.h"

namespace podm::test {

/// Returns every cell as four sorted points. Equal triangulations give equal results, whatever their ids.
inline std::vector<std::array<std::array<double, 3>, 4>> cells_by_points(const Mesh& mesh) {
  std::vector<std::array<std::array<double, 3>, 4>> all;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    std::array<std::array<double, 3>, 4> points;
    for (unsigned i = 0; i < 4; ++i) {
      const Point& p = mesh.point(mesh.cell(c).vertices[i]);
      points[i] = {p.x, p.y, p.z};
    }
    std::sort(points.begin(), points.end());
    all.push_back(points);
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace podm::test
