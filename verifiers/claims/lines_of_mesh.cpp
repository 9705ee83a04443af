#include "claims/lines_of_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace podm::verify {

namespace {

// An edge of a side, and a label beside it.
struct Beside {
  std::array<VertexId, 2> edge{};
  LabelIndex label = 0;
  CellId cell = 0;
};

std::vector<Beside> labels_beside_edges(const std::vector<Side>& sides) {
  std::vector<Beside> beside;
  beside.reserve(6 * sides.size());
  for (const Side& side : sides) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [least, largest] = std::minmax(side.vertices[i], side.vertices[(i + 1) % 3]);
      for (const LabelIndex label : {side.label, side.across})
        beside.push_back({{least, largest}, label, side.cell});
    }
  }
  std::sort(beside.begin(), beside.end(), [](const Beside& a, const Beside& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.label != b.label ? a.label < b.label : a.cell < b.cell;
  });
  return beside;
}

}  // namespace

std::vector<LineEdge> lines_of_mesh(const Mesh& mesh, const Adjacency& adjacency, int threads) {
  const CellLabelIndices label_indices(mesh);
  const auto beside = labels_beside_edges(find_sides(mesh, adjacency, label_indices, threads));
  std::vector<LineEdge> edges;
  for (auto first = beside.begin(); first != beside.end();) {
    LineEdge edge{first->edge, {}, first->cell};
    auto last = first;
    for (; last != beside.end() && last->edge == edge.vertices; ++last) {
      const LabelValue label = label_indices.labels[last->label];
      if (edge.labels.empty() || edge.labels.back() != label) edge.labels.push_back(label);
    }
    first = last;
    if (edge.labels.size() >= 3) edges.push_back(std::move(edge));
  }
  return edges;
}

LineSegments::LineSegments(const Mesh& mesh, const std::vector<LineEdge>& edges, const ImageFrame& frame) {
  for (const LineEdge& edge : edges)
    ends_.push_back(
        {frame.to_world(mesh.vertices[edge.vertices[0]]), frame.to_world(mesh.vertices[edge.vertices[1]])});
}

Point LineSegments::closest(std::uint32_t i, const Point& p) const {
  const auto& [a, b] = ends_[i];
  double along = 0, squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    along += (p[axis] - a[axis]) * (b[axis] - a[axis]);
    squared += (b[axis] - a[axis]) * (b[axis] - a[axis]);
  }
  const double t = squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0;
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

void LineSegments::bounds(std::uint32_t i, Point& low, Point& high) const {
  const auto& [a, b] = ends_[i];
  for (std::size_t axis = 0; axis < 3; ++axis)
    std::tie(low[axis], high[axis]) = std::minmax(a[axis], b[axis]);
}

double LineSegments::length(std::size_t i) const {
  const auto& [a, b] = ends_[i];
  return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
}

}  // namespace podm::verify
