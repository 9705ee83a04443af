#include "claims/check_structure_overlap.h"

#include <algorithm>

#include "geometry/box_tree.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// The boundary facets of a mesh, turned so that their own cells lie on the positive side.
class BoundaryFacets {
 public:
  BoundaryFacets(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed)
      : mesh_(mesh), is_left_handed_(is_left_handed), facets_(without_mirror(adjacency)), tree_(boxes()) {}

  CellId own_cell(std::size_t i) const { return facets_[i] / 4; }
  std::array<VertexId, 3> vertices(std::size_t i) const {
    auto v = vertices_of(mesh_, facets_[i]);
    if (is_left_handed_) std::swap(v[1], v[2]);
    return v;
  }
  TrianglePoints points(std::size_t i) const { return points_of(mesh_, vertices(i)); }

  /// Calls visit(facet, points) for every facet whose box meets `box`.
  template <class Visit>
  void for_each_near(const Bounds& box, const Visit& visit) const {
    tree_.for_each_near([&](const Bounds& other) { return meet(box, other); },
                        [&](std::size_t i) {
                          const TrianglePoints p = points(i);
                          if (meet(box, bounds_of(p))) visit(i, p);
                        });
  }

 private:
  static std::vector<FacetId> without_mirror(const Adjacency& adjacency) {
    std::vector<FacetId> facets;
    for (FacetId f = 0; f < adjacency.mirror.size(); ++f)
      if (adjacency.mirror[f] == kNone) facets.push_back(f);
    return facets;
  }
  std::vector<Bounds> boxes() const {
    std::vector<Bounds> boxes;
    boxes.reserve(facets_.size());
    for (std::size_t i = 0; i < facets_.size(); ++i) boxes.push_back(bounds_of(points(i)));
    return boxes;
  }

  const Mesh& mesh_;
  bool is_left_handed_;
  std::vector<FacetId> facets_;
  BoxTree tree_;
};

// Returns orientation(p, x). It returns at once if x is a corner of the triangle, as it mostly is for
// neighbours.
int side_of_plane(const TrianglePoints& p, const Point& x, std::uint64_t& num_exact) {
  return x == p[0] || x == p[1] || x == p[2] ? 0 : orientation(p[0], p[1], p[2], x, num_exact);
}

bool is_separated_by_a_facet_of(const CellPoints& cell, const TrianglePoints& facet,
                                std::uint64_t& num_exact) {
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& local = kFacetVertices[k];
    const TrianglePoints own{cell[static_cast<std::size_t>(local[0])],
                             cell[static_cast<std::size_t>(local[1])],
                             cell[static_cast<std::size_t>(local[2])]};
    const int inner = orientation(own[0], own[1], own[2], cell[k], num_exact);
    bool is_outer = true, is_in_plane = true;
    for (const Point& x : facet) {
      const int s = side_of_plane(own, x, num_exact) * inner;
      is_outer = is_outer && s <= 0;
      is_in_plane = is_in_plane && s == 0;
    }
    if (is_outer && !is_in_plane) return true;
  }
  return false;
}

// True if the plane through the edge ab of a facet, parallel to the cell's edge, leaves the facet, whose
// third vertex is `third`, and the cell on different sides; touching is allowed. The facet's own plane does
// not count.
bool is_separated_along(const Point& a, const Point& b, const Point& third, const CellPoints& cell,
                        const std::array<int, 2>& edge, std::uint64_t& num_exact) {
  const auto first = static_cast<std::size_t>(edge[0]), second = static_cast<std::size_t>(edge[1]);
  const Point &c = cell[first], &d = cell[second];
  const auto is_end = [&](const Point& x) { return x == a || x == b; };
  if ((is_end(c) || c == third) && (is_end(d) || d == third)) return false;
  const auto side_of = [&](const Point& x) {
    return sign_of(
        [&]<class T>(T) { return dot(cross(difference<T>(b, a), difference<T>(d, c)), difference<T>(x, a)); },
        num_exact);
  };
  const int of_facet = side_of(third);
  if (of_facet == 0) return false;
  for (std::size_t k = 0; k < 4; ++k) {
    if (is_end(cell[k]) || k == second || (k == first && is_end(d))) continue;  // 0, or c's side
    if (side_of(cell[k]) * of_facet > 0) return false;
  }
  return true;
}

bool is_separated_along_edges(const CellPoints& cell, const TrianglePoints& facet, std::uint64_t& num_exact) {
  for (std::size_t i = 0; i < 3; ++i)
    for (const auto& edge : kEdges)
      if (is_separated_along(facet[i], facet[(i + 1) % 3], facet[(i + 2) % 3], cell, edge, num_exact))
        return true;
  return false;
}

// True if the inside of the cell meets every neighbourhood of some inner point of the facet, on its positive
// side.
bool is_just_inside(const CellPoints& cell, const TrianglePoints& facet, std::uint64_t& num_exact) {
  bool reaches_inside = false, has_gap = true;
  for (const Point& x : cell) {
    const int side = side_of_plane(facet, x, num_exact);
    reaches_inside = reaches_inside || side > 0;
    has_gap = has_gap && side > 0;
  }
  return reaches_inside && !has_gap && !is_separated_by_a_facet_of(cell, facet, num_exact) &&
         !is_separated_along_edges(cell, facet, num_exact);
}

// True if x, in the plane of the triangle, lies in it or on its edges.
bool is_in_triangle(const TrianglePoints& p, const Point& x, std::uint64_t& num_exact) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto turn = [&]<class T>(T) {
      const auto normal = cross(difference<T>(p[1], p[0]), difference<T>(p[2], p[0]));
      return dot(cross(normal, difference<T>(p[(i + 1) % 3], p[i])), difference<T>(x, p[i]));
    };
    if (sign_of(turn, num_exact) < 0) return false;
  }
  return true;
}

}  // namespace

Tally check_overlap(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed, int threads) {
  const BoundaryFacets facets(mesh, adjacency, is_left_handed);
  return tally_over(mesh.cells.size(), threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints cell = points_of(mesh, c);
    facets.for_each_near(bounds_of(cell), [&](std::size_t facet, const TrianglePoints& p) {
      if (facets.own_cell(facet) == c) return;
      ++t.num_checked;
      if (!is_just_inside(cell, p, t.num_exact)) return;
      const auto v = facets.vertices(facet);
      t.violation({.statement = "no cells overlap",
                   .cells = {facets.own_cell(facet), c},
                   .vertices = {v.begin(), v.end()},
                   .points = {p.begin(), p.end()}});
    });
  });
}

Tally check_hanging_vertices(const Mesh& mesh, const Adjacency& adjacency, int threads) {
  const BoundaryFacets facets(mesh, adjacency, false);
  const std::vector<std::uint8_t> is_used = used_vertices(mesh);
  return tally_over(mesh.vertices.size(), threads, {}, [&](std::size_t i, Tally& t) {
    if (!is_used[i]) return;
    const Point& x = mesh.vertices[i];
    facets.for_each_near({x, x}, [&](std::size_t facet, const TrianglePoints& p) {
      if (std::find(p.begin(), p.end(), x) != p.end()) return;  // coincident ones are another test's
      ++t.num_checked;
      if (orientation(p[0], p[1], p[2], x, t.num_exact) != 0 || !is_in_triangle(p, x, t.num_exact)) return;
      const auto v = facets.vertices(facet);
      t.violation({.statement = "no vertex hangs on a facet or edge",
                   .cells = {facets.own_cell(facet)},
                   .vertices = {static_cast<VertexId>(i), v[0], v[1], v[2]},
                   .points = {x}});
    });
  });
}

}  // namespace podm::verify
