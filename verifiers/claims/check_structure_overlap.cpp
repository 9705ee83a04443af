#include "claims/check_structure_overlap.h"

#include "geometry/box_grid.h"
#include "geometry/measures.h"

namespace podm::verify {

namespace {

// The boundary facets of a mesh, turned so that their own cells lie on the positive side.
class BoundaryFacets {
 public:
  BoundaryFacets(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed) : mesh_(mesh) {
    std::vector<Bounds> boxes;
    for (FacetId f = 0; f < adjacency.mirror.size(); ++f) {
      if (adjacency.mirror[f] != kNone) continue;
      facets_.push_back(f);
      boxes.push_back(bounds_of(points(facets_.size() - 1)));
    }
    grid_ = BoxGrid(boxes);
    is_left_handed_ = is_left_handed;
  }

  std::size_t size() const { return facets_.size(); }
  CellId own_cell(std::size_t i) const { return facets_[i] / 4; }
  std::array<VertexId, 3> vertices(std::size_t i) const {
    const auto& local = kFacetVertices[facets_[i] % 4];
    const auto& cell = mesh_.cells[facets_[i] / 4];
    const auto at = [&](int k) { return cell[static_cast<std::size_t>(local[static_cast<std::size_t>(k)])]; };
    if (is_left_handed_) return {at(0), at(2), at(1)};
    return {at(0), at(1), at(2)};
  }
  TrianglePoints points(std::size_t i) const {
    const auto v = vertices(i);
    return {mesh_.vertices[v[0]], mesh_.vertices[v[1]], mesh_.vertices[v[2]]};
  }
  const BoxGrid& grid() const { return grid_; }

 private:
  const Mesh& mesh_;
  bool is_left_handed_ = false;
  std::vector<FacetId> facets_;
  BoxGrid grid_{{}};
};

// As orientation(), at once where x is one of the others, as with neighbours it mostly is.
int side_of_plane(const Point& a, const Point& b, const Point& c, const Point& x) {
  return x == a || x == b || x == c ? 0 : orientation(a, b, c, x);
}

// The sign of det(u, v, x - a) for vectors that `plane(T)` returns as {u, v}.
template <class Plane>
int side(const Plane& plane, const Point& a, const Point& x, std::uint64_t& num_exact) {
  return sign_of(
      [&]<class T>(T) {
        const auto [u, v] = plane(T());
        return dot(cross(u, v), difference<T>(x, a));
      },
      num_exact);
}

// Whether the plane along the edge ab leaves the facet and the cell on different sides, touching allowed; a
// plane that holds all of the facet does not count.
template <class Plane>
bool separates(const Plane& plane, const Point& a, const Point& b, const TrianglePoints& facet,
               const CellPoints& cell, std::uint64_t& num_exact) {
  const auto side_of = [&](const Point& x) { return x == a || x == b ? 0 : side(plane, a, x, num_exact); };
  int of_facet = 0;
  for (const Point& x : facet) {
    const int s = side_of(x);
    if (s * of_facet < 0) return false;
    if (s != 0) of_facet = s;
  }
  if (of_facet == 0) return false;
  for (const Point& x : cell)
    if (side_of(x) * of_facet > 0) return false;
  return true;
}

bool is_separated_by_a_facet_of(const CellPoints& cell, const TrianglePoints& facet) {
  for (std::size_t k = 0; k < 4; ++k) {
    const Point &a = cell[static_cast<std::size_t>(kFacetVertices[k][0])],
                &b = cell[static_cast<std::size_t>(kFacetVertices[k][1])],
                &c = cell[static_cast<std::size_t>(kFacetVertices[k][2])];
    const int inner = orientation(a, b, c, cell[k]);
    bool is_outer = true, is_in_plane = true;
    for (const Point& x : facet) {
      const int s = side_of_plane(a, b, c, x) * inner;
      is_outer = is_outer && s <= 0;
      is_in_plane = is_in_plane && s == 0;
    }
    if (is_outer && !is_in_plane) return true;
  }
  return false;
}

bool is_separated_along_edges(const CellPoints& cell, const TrianglePoints& facet, std::uint64_t& num_exact) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Point &a = facet[i], &b = facet[(i + 1) % 3];
    for (const auto& edge : kEdges) {
      const Point &c = cell[static_cast<std::size_t>(edge[0])], &d = cell[static_cast<std::size_t>(edge[1])];
      const auto plane = [&]<class T>(T) { return std::pair(difference<T>(b, a), difference<T>(d, c)); };
      if (separates(plane, a, b, facet, cell, num_exact)) return true;
    }
    const auto side_of_prism = [&]<class T>(T) {
      const auto ab = difference<T>(b, a);
      return std::pair(ab, cross(difference<T>(facet[1], facet[0]), difference<T>(facet[2], facet[0])));
    };
    if (separates(side_of_prism, a, b, facet, cell, num_exact)) return true;
  }
  return false;
}

// Whether the inside of the cell meets every neighbourhood of some inner point of the facet, on its positive
// side.
bool is_just_inside(const CellPoints& cell, const TrianglePoints& facet, std::uint64_t& num_exact) {
  bool reaches_inside = false, is_off_the_plane = true;  // the latter: with a gap
  for (const Point& x : cell) {
    const int side = side_of_plane(facet[0], facet[1], facet[2], x);
    reaches_inside = reaches_inside || side > 0;
    is_off_the_plane = is_off_the_plane && side > 0;
  }
  return reaches_inside && !is_off_the_plane && !is_separated_by_a_facet_of(cell, facet) &&
         !is_separated_along_edges(cell, facet, num_exact);
}

// Whether x, in the plane of the triangle, lies in it or on its edges.
bool is_in_triangle(const TrianglePoints& p, const Point& x, std::uint64_t& num_exact) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto plane = [&]<class T>(T) {
      return std::pair(cross(difference<T>(p[1], p[0]), difference<T>(p[2], p[0])),
                       difference<T>(p[(i + 1) % 3], p[i]));
    };
    if (side(plane, p[i], x, num_exact) < 0) return false;
  }
  return true;
}

}  // namespace

Tally check_overlap(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed, int threads) {
  const BoundaryFacets facets(mesh, adjacency, is_left_handed);
  return tally_over(mesh.cells.size(), threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints cell = points_of(mesh, c);
    const Bounds box = bounds_of(cell);
    std::vector<std::size_t> met;  // facets found so far: a grid may name one twice
    facets.grid().for_each_near(box, [&](std::size_t facet) {
      if (facets.own_cell(facet) == c) return;
      const TrianglePoints p = facets.points(facet);
      if (!meet(box, bounds_of(p))) return;
      ++t.num_checked;
      if (!is_just_inside(cell, p, t.num_exact) || std::find(met.begin(), met.end(), facet) != met.end())
        return;
      met.push_back(facet);
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
  return tally_over(mesh.vertices.size(), threads, {}, [&](std::size_t i, Tally& t) {
    const auto v = static_cast<VertexId>(i);
    const Point& x = mesh.vertices[v];
    const Bounds box{x, x};
    facets.grid().for_each_near(box, [&](std::size_t facet) {
      const auto own = facets.vertices(facet);
      if (std::find(own.begin(), own.end(), v) != own.end()) return;
      const TrianglePoints p = facets.points(facet);
      if (!meet(box, bounds_of(p))) return;
      ++t.num_checked;
      if (std::find(p.begin(), p.end(), x) != p.end()) return;  // coincident vertices are told apart
      if (orientation(p[0], p[1], p[2], x) != 0 || !is_in_triangle(p, x, t.num_exact)) return;
      t.violation({.statement = "no vertex hangs on a facet or edge",
                   .cells = {facets.own_cell(facet)},
                   .vertices = {v, own[0], own[1], own[2]},
                   .points = {x}});
    });
  });
}

}  // namespace podm::verify
