// The edges of a mesh around which three or more labels meet, the background counted.
#pragma once

#include <array>
#include <vector>

#include "claims/check_surface_boundary.h"
#include "image/image_frame.h"

namespace podm::verify {

struct LineEdge {
  std::array<VertexId, 2> vertices{};  ///< ascending
  std::vector<LabelValue> labels;      ///< ascending; three or more
  CellId cell = 0;                     ///< a cell with the edge
};

/// Collective. Returns the line edges, in ascending order of their vertices. On ranks those at vertices of
/// the rank's own cells are right.
std::vector<LineEdge> lines_of_mesh(const Mesh& mesh, const Adjacency& adjacency, int threads);

/// The edges as segments in the world, for NearestTree (claims/check_fidelity_tree.h).
class LineSegments {
 public:
  LineSegments(const Mesh& mesh, const std::vector<LineEdge>& edges, const ImageFrame& frame);

  const std::array<Point, 2>& operator[](std::size_t i) const { return ends_[i]; }
  Point closest(std::uint32_t i, const Point& p) const;
  void bounds(std::uint32_t i, Point& low, Point& high) const;
  double length(std::size_t i) const;

 private:
  std::vector<std::array<Point, 2>> ends_;
};

}  // namespace podm::verify
