#include "delaunay/star.h"

#include <bit>
#include <limits>

namespace podm {

bool StarFiller::prepare(Mesh& mesh, const Region& region, const Point& p) {
  if (region.boundary.size() > kMaxFacets) return false;
  num_vertices_ = 0;
  num_facets_ = 0;
  squared_distance_ = std::numeric_limits<double>::infinity();
  for (const FacetId f : region.boundary) {
    const Cell& cell = mesh.cell(cell_of(f));
    const auto k = static_cast<unsigned>(index_in_cell(f));
    Facet& facet = facets_[num_facets_++];
    facet.mirror = cell.mirrors[k];
    for (unsigned i = 0; i < 3; ++i) {
      const VertexId v = cell.vertices[static_cast<unsigned>(kFacetVertices[k][i])];
      Vertex& vertex = mesh.vertex(v);
      unsigned local = vertex.local_index;
      if (local >= num_vertices_ || ids_[local] != v) {
        if (num_vertices_ == kMaxVertices) return false;
        local = num_vertices_++;
        ids_[local] = v;
        vertex.local_index = static_cast<std::uint16_t>(local);
        const Vector e = vertex.point - p;
        const double s = squared_length(e);
        offsets_[local] = {e.x, e.y, e.z, s};
        squared_distance_ = std::min(squared_distance_, s);
      }
      facet.vertices[i] = v;
      facet.local[i] = static_cast<std::uint16_t>(local);
    }
  }
  row_bits_ = static_cast<unsigned>(std::bit_width(num_vertices_ - 1));
  if (facet_at_edge_.size() < std::size_t{1} << (2 * row_bits_))
    facet_at_edge_.resize(std::size_t{1} << (2 * row_bits_));
  return true;
}

void StarFiller::compute_spheres(const Mesh& mesh, const Point& p) {
  for (unsigned f = 0; f < num_facets_; ++f) {
    const auto& a = offsets_[facets_[f].local[0]];
    const auto& b = offsets_[facets_[f].local[1]];
    const auto& c = offsets_[facets_[f].local[2]];
    const RelativeSphere s =
        relative_sphere({a[0], a[1], a[2]}, {b[0], b[1], b[2]}, {c[0], c[1], c[2]}, a[3], b[3], c[3]);
    const Point center =
        is_well_conditioned(s.determinant, s.squared_length)
            ? p + s.center
            : exact_circumcenter(mesh.point(facets_[f].vertices[0]), mesh.point(facets_[f].vertices[1]),
                                 mesh.point(facets_[f].vertices[2]), p);
    spheres_[0][f] = center.x;
    spheres_[1][f] = center.y;
    spheres_[2][f] = center.z;
    spheres_[3][f] = certified_squared_radius(center, p, mesh.extent());
  }
}

void StarFiller::fill(Mesh& mesh, Pool& pool, Region& region, VertexId apex) {
  compute_spheres(mesh, mesh.point(apex));
  pool.replace(region.cells, num_facets_, region.created);
  for (unsigned f = 0; f < num_facets_; ++f) {
    const Facet& facet = facets_[f];
    const CellId id = region.created[f];
    mesh.renew(id, {facet.vertices[0], facet.vertices[1], facet.vertices[2], apex});
    mesh.set_sphere(id, {{spheres_[0][f], spheres_[1][f], spheres_[2][f]}, spheres_[3][f]});
    mesh.new_cell(id).mirrors[3] = facet.mirror;
    mesh.set_mirror(facet.mirror, 4 * id + 3);
    const unsigned a = facet.local[0], b = facet.local[1], c = facet.local[2];
    facet_at_edge_[(b << row_bits_) + c] = 4 * id + 0;
    facet_at_edge_[(c << row_bits_) + a] = 4 * id + 1;
    facet_at_edge_[(a << row_bits_) + b] = 4 * id + 2;
  }
  for (unsigned f = 0; f < num_facets_; ++f) {
    const unsigned a = facets_[f].local[0], b = facets_[f].local[1], c = facets_[f].local[2];
    auto& mirrors = mesh.new_cell(region.created[f]).mirrors;
    mirrors[0] = facet_at_edge_[(c << row_bits_) + b];
    mirrors[1] = facet_at_edge_[(a << row_bits_) + c];
    mirrors[2] = facet_at_edge_[(b << row_bits_) + a];
  }
}

}  // namespace podm
