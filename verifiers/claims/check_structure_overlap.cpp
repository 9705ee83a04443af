#include "claims/check_structure_overlap.h"

#include <algorithm>

#include "geometry/box_tree.h"
#include "geometry/measures.h"
#include "geometry/rank_boxes.h"

namespace podm::verify {

namespace {

// A boundary facet that may be another rank's, turned so that its own cell lies on the positive side.
struct BoundaryFacet {
  GlobalId cell;
  std::array<GlobalId, 3> vertices;
  TrianglePoints points;
};

// The boundary facets near the rank's own cells and vertices.
class BoundaryFacets {
 public:
  BoundaryFacets(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed)
      : facets_(near_rank(mesh, without_mirror(mesh, adjacency, is_left_handed))), tree_(boxes()) {}

  /// Calls visit(facet) for every facet whose box meets `box`.
  template <class Visit>
  void for_each_near(const Bounds& box, const Visit& visit) const {
    tree_.for_each_near([&](const Bounds& other) { return meet(box, other); },
                        [&](std::size_t i) {
                          if (meet(box, bounds_of(facets_[i].points))) visit(facets_[i]);
                        });
  }

 private:
  static std::vector<BoundaryFacet> without_mirror(const Mesh& mesh, const Adjacency& adjacency,
                                                   bool is_left_handed) {
    std::vector<BoundaryFacet> facets;
    const IdRange own = own_facets(mesh);
    for (auto f = static_cast<FacetId>(own.begin); f < own.end; ++f) {
      if (adjacency.mirror[f] != kNone) continue;
      auto v = vertices_of(mesh, f);
      if (is_left_handed) std::swap(v[1], v[2]);
      facets.push_back({global_cell(mesh, f / 4),
                        {global_vertex(mesh, v[0]), global_vertex(mesh, v[1]), global_vertex(mesh, v[2])},
                        points_of(mesh, v)});
    }
    return facets;
  }
  // Returns boxes of the rank's own cells and vertices. A vertex of its own may be on cells of other ranks
  // only.
  static std::vector<Bounds> boxes_of_rank(const Mesh& mesh) {
    const IdRange cells = own_cells(mesh);
    std::vector<Bounds> boxes = boxes_of_ranges(cells.size(), [&](std::size_t i) {
      return bounds_of(points_of(mesh, static_cast<CellId>(cells.begin + i)));
    });
    const std::vector<Bounds> of_vertices = boxes_of_ranges(mesh.vertices.size(), [&](std::size_t v) {
      return owns_vertex(mesh, v) ? Bounds{mesh.vertices[v], mesh.vertices[v]} : kEmptyBounds;
    });
    boxes.insert(boxes.end(), of_vertices.begin(), of_vertices.end());
    return boxes;
  }
  // Collective. Returns the facets of all ranks whose boxes meet one of this rank's.
  static std::vector<BoundaryFacet> near_rank(const Mesh& mesh, std::vector<BoundaryFacet> own) {
    const RankBoxes boxes(ranks_of(mesh), boxes_of_rank(mesh));
    auto lists = lists_for<BoundaryFacet>(ranks_of(mesh));
    for (const BoundaryFacet& facet : own) {
      const Bounds near = bounds_of(facet.points);
      boxes.for_each_other([&](const Bounds& box) { return meet(near, box); },
                           [&](std::size_t rank) { lists[rank].push_back(facet); });
    }
    lists[static_cast<std::size_t>(ranks_of(mesh).rank())] = std::move(own);
    return exchange_joined(ranks_of(mesh), std::move(lists));
  }
  std::vector<Bounds> boxes() const {
    std::vector<Bounds> boxes;
    boxes.reserve(facets_.size());
    for (const BoundaryFacet& facet : facets_) boxes.push_back(bounds_of(facet.points));
    return boxes;
  }

  std::vector<BoundaryFacet> facets_;
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
  return tally_over(own_cells(mesh), threads, {}, [&](std::size_t i, Tally& t) {
    const auto c = static_cast<CellId>(i);
    const CellPoints cell = points_of(mesh, c);
    facets.for_each_near(bounds_of(cell), [&](const BoundaryFacet& facet) {
      if (facet.cell == global_cell(mesh, c)) return;
      ++t.num_checked;
      if (!is_just_inside(cell, facet.points, t.num_exact)) return;
      t.violation({.statement = "no cells overlap",
                   .cells = {facet.cell, global_cell(mesh, c)},
                   .vertices = {facet.vertices.begin(), facet.vertices.end()},
                   .points = {facet.points.begin(), facet.points.end()}});
    });
  });
}

Tally check_hanging_vertices(const Mesh& mesh, const Adjacency& adjacency, int threads) {
  const BoundaryFacets facets(mesh, adjacency, false);
  const std::vector<std::uint8_t> is_used = used_vertices(mesh);
  return tally_over({0, mesh.vertices.size()}, threads, {}, [&](std::size_t i, Tally& t) {
    if (!is_used[i] || !owns_vertex(mesh, i)) return;
    const Point& x = mesh.vertices[i];
    facets.for_each_near({x, x}, [&](const BoundaryFacet& facet) {
      const TrianglePoints& p = facet.points;
      if (std::find(p.begin(), p.end(), x) != p.end()) return;  // coincident ones are another test's
      ++t.num_checked;
      if (orientation(p[0], p[1], p[2], x, t.num_exact) != 0 || !is_in_triangle(p, x, t.num_exact)) return;
      const auto& v = facet.vertices;
      t.violation({.statement = "no vertex hangs on a facet or edge",
                   .cells = {facet.cell},
                   .vertices = {global_vertex(mesh, static_cast<VertexId>(i)), v[0], v[1], v[2]},
                   .points = {x}});
    });
  });
}

}  // namespace podm::verify
