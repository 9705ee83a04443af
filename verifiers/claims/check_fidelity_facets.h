// The facets between different labels of a mesh, as triangles of the world, and sample points on them.
#pragma once

#include <vector>

#include "claims/check_fidelity_tree.h"
#include "geometry/adjacency.h"
#include "image/image_frame.h"

namespace podm::verify {

struct InterfaceFacet {
  std::array<VertexId, 3> vertices{};
  std::array<LabelValue, 2> labels{};  ///< of the cell, and of the cell across or 0
  CellId cell = 0;
};

class InterfaceFacets {
 public:
  /// Collective. Takes the facets of the rank's own cells.
  InterfaceFacets(const Mesh& mesh, const Adjacency& adjacency, const ImageFrame& frame, int threads);

  const std::vector<InterfaceFacet>& all() const { return facets_; }
  std::array<Point, 3> triangle(std::uint32_t i) const;
  Point closest(std::uint32_t i, const Point& p) const;
  void bounds(std::uint32_t i, Point& low, Point& high) const;
  /// Returns mm^2.
  double area(std::uint32_t i) const;

  /// Calls visit(point, share) for points spread evenly, neighbours less than half a voxel apart, vertices
  /// and points of the edges among them. The shares of a facet sum to 1.
  template <class Visit>
  void sample(std::uint32_t i, Visit visit) const;

 private:
  /// Returns the number of parts that edges are cut into.
  int num_parts(const std::array<Point, 3>& triangle) const;

  const ImageFrame& frame_;
  std::vector<Point> points_;  // of the mesh's vertices, world mm
  std::vector<InterfaceFacet> facets_;
};

template <class Visit>
void InterfaceFacets::sample(std::uint32_t i, Visit visit) const {
  const std::array<Point, 3> t = triangle(i);
  const int n = num_parts(t);
  // Each small triangle gives a third of its area to each corner: 6 triangles meet inside, 3 at an edge.
  const double third = 1.0 / (3.0 * n * n);
  for (int a = 0; a <= n; ++a)
    for (int b = 0; a + b <= n; ++b) {
      const int c = n - a - b;
      const int zeros = (a == 0) + (b == 0) + (c == 0);
      Point p;
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] = (a * t[0][axis] + b * t[1][axis] + c * t[2][axis]) / n;
      visit(p, third * (zeros == 0 ? 6 : zeros == 1 ? 3 : 1));
    }
}

}  // namespace podm::verify
