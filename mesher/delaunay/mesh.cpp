#include "delaunay/mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/predicates.h"

namespace podm {

namespace {

// A tetrahedralisation of V vertices has at most about 6.8 V cells on average inputs of refinement. The
// number of vertex ids is bounded by cells / 4, which leaves slack for sparse starts.
std::size_t vertex_capacity_for(std::size_t cell_capacity) { return cell_capacity / 4 + 4096; }

// The cells or vertices of one run of ids fill a huge page of 2 MiB.
constexpr unsigned kCellRunBits = 15, kVertexRunBits = 16;
static_assert(sizeof(Cell) << kCellRunBits == 1 << 21 && sizeof(Vertex) << kVertexRunBits == 1 << 21);

// Runs are shorter in a small store, where a node would otherwise have few runs or none.
unsigned run_bits_for(std::size_t capacity, int num_nodes, unsigned most_bits) {
  const std::size_t longest = capacity / (16 * static_cast<std::size_t>(num_nodes));
  constexpr unsigned kLeastBits = 3;  // the box takes eight vertices at once
  return std::clamp(static_cast<unsigned>(std::bit_width(longest / 2)), kLeastBits, most_bits);
}

double largest_coordinate(const Box& b) {
  return std::max({std::abs(b.low.x), std::abs(b.low.y), std::abs(b.low.z), std::abs(b.high.x),
                   std::abs(b.high.y), std::abs(b.high.z)});
}

}  // namespace

Mesh::Mesh(const Box& box, std::size_t cell_capacity, int num_nodes, SharedIds* shared_cells)
    : box_(box),
      extent_(largest_coordinate(box)),
      cells_(cell_capacity),
      vertices_(vertex_capacity_for(cell_capacity)),
      cell_ids_(cells_.capacity(), num_nodes, run_bits_for(cell_capacity, num_nodes, kCellRunBits),
                shared_cells),
      vertex_ids_(vertices_.capacity(), num_nodes,
                  run_bits_for(vertices_.capacity(), num_nodes, kVertexRunBits)) {
  // Kuhn's six cells around the diagonal from corner 0 to corner 7 (bit 0: x, 1: y, 2: z). All eight corners
  // are cospherical. The perturbation of predicates.h, which lowers the largest corner most, selects these
  // cells.
  vertex_ids_.take(8, 0);
  for (unsigned corner = 0; corner < 8; ++corner) {
    vertices_[corner] = {{(corner & 1) ? box.high.x : box.low.x, (corner & 2) ? box.high.y : box.low.y,
                          (corner & 4) ? box.high.z : box.low.z},
                         0,
                         0,
                         VertexKind::kBox};
  }
  static constexpr std::array<std::array<VertexId, 2>, 6> kPaths{
      {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}};
  cell_ids_.take(6, 0);
  for (CellId c = 0; c < 6; ++c) {
    // Neighbouring paths share an edge from 0 to 7; the ring turns counter-clockwise seen from 7.
    cells_[c].vertices = {0, kPaths[c][0], kPaths[c][1], 7};
    const CellId next = (c + 1) % 6, previous = (c + 5) % 6;
    cells_[c].mirrors = {kNoFacet, 4 * next + 2, 4 * previous + 1, kNoFacet};
    refresh_sphere(c);
  }
}

void Mesh::refresh_sphere(CellId c) {
  const auto& v = cells_[c].vertices;
  set_sphere(c, circumsphere(point(v[0]), point(v[1]), point(v[2]), point(v[3]), extent_));
}

void Mesh::make_canonical(CellId c) {
  const auto& v = cells_[c].vertices;
  std::array<Point, 4> p{point(v[0]), point(v[1]), point(v[2]), point(v[3])};
  std::sort(p.begin(), p.end(), lexicographically_less);
  set_sphere(c, circumsphere(p[0], p[1], p[2], p[3], extent_));
  cells_[c].label = kUnknownLabel;
}

void Mesh::move_cell(CellId from, CellId to, const std::array<VertexId, 4>& vertices,
                     const std::array<FacetId, 4>& mirrors) {
  const Cell old = cells_[from];
  if (to != from) renew(from, {kNoVertex, kNoVertex, kNoVertex, kNoVertex});
  renew(to, vertices);
  set_mirrors(to, mirrors);
  set_sphere(to, {old.center, old.squared_radius});
  cells_[to].label = old.label;
}

bool Mesh::is_in_conflict(CellId c, const Point& p) const {
  assert_may_read(*this, c);
  const Side side = side_of(cells_[c].center, cells_[c].squared_radius, p);
  if (side != Side::kUndecided) return side == Side::kInside;
  const auto& v = cells_[c].vertices;
  return in_circumsphere(point(v[0]), point(v[1]), point(v[2]), point(v[3]), p);
}

std::uint64_t Mesh::num_cells() const {
  std::uint64_t count = 0;
  for (CellId c = 0; c < cell_bound(); ++c) count += cells_[c].is_alive();
  return count;
}

}  // namespace podm
