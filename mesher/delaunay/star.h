// Fills a cavity with the star of its new vertex: one cell per boundary facet. This is the common case and
// the hottest code of the mesher.
#pragma once

#include <array>
#include <cstdint>

#include "delaunay/facets_at_edges.h"
#include "delaunay/pool.h"
#include "delaunay/region.h"

namespace podm {

class StarFiller {
 public:
  /// Numbers the boundary's vertices and measures their distances from p. Writes nothing except the scratch
  /// Vertex::local_index. Returns false if there are more than fit; then HoleFiller must be used.
  bool prepare(Mesh& mesh, const Region& region, const Point& p);
  std::size_t num_cells() const { return num_facets_; }
  /// The squared distance from p to the nearest vertex of the prepared boundary, mm^2.
  double squared_distance() const { return squared_distance_; }
  /// Calls visit(VertexId) once for each vertex of the prepared boundary whose squared distance from p is
  /// below `squared_reach`, mm^2.
  template <class Visit>
  void for_each_vertex_within(double squared_reach, const Visit& visit) const {
    for (unsigned i = 0; i < num_vertices_; ++i)
      if (offsets_[i][3] < squared_reach) visit(ids_[i]);
  }
  /// Replaces the region by the star of `apex`, whose point is p, and sets the spheres of the new cells.
  void fill(Mesh& mesh, Pool& pool, Region& region, VertexId apex);

 private:
  static constexpr unsigned kMaxVertices = 1024;
  static constexpr unsigned kMaxFacets = 2 * kMaxVertices;

  struct Facet {
    std::array<VertexId, 3> vertices;
    std::array<std::uint16_t, 3> local;
    FacetId mirror;
  };
  // A group of facets, laid out for loops that compilers turn into vector instructions.
  struct alignas(64) Lanes {
    static constexpr unsigned kSize = 8;
    using Row = std::array<double, kSize>;
    std::array<Row, 12> offsets;  // of the three vertices
    std::array<Row, 4> spheres;   // of the new cells: center, squared radius
    bool compute_spheres(Point p, double extent);
  };
  void compute_spheres(const Mesh& mesh, const Point& p);
  void collect_offsets();

  unsigned num_vertices_ = 0, num_facets_ = 0;
  double squared_distance_ = 0;
  std::array<VertexId, kMaxVertices> ids_;
  alignas(64) std::array<std::array<double, 4>, kMaxVertices> offsets_;  // x-p and |x-p|^2
  std::array<Facet, kMaxFacets> facets_;
  std::array<Lanes, kMaxFacets / Lanes::kSize> lanes_;
  FacetsAtEdges facets_at_edges_;
  FacetsAtEdges::Table at_edges_;  // of the prepared boundary
};

}  // namespace podm
