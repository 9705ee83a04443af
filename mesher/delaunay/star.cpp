#include "delaunay/star.h"

#include <algorithm>
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
  facets_at_edges_.begin(num_vertices_);
  return true;
}

void StarFiller::collect_offsets() {
  // The unused part of the last lanes repeats the last facet.
  for (unsigned lane = 0; lane < (num_facets_ + Lanes::kSize - 1) / Lanes::kSize * Lanes::kSize; ++lane) {
    Lanes& lanes = lanes_[lane / Lanes::kSize];
    const Facet& facet = facets_[std::min(lane, num_facets_ - 1)];
    for (unsigned i = 0; i < 3; ++i) {
      for (unsigned k = 0; k < 4; ++k)
        lanes.offsets[4 * i + k][lane % Lanes::kSize] = offsets_[facet.local[i]][k];
    }
  }
}

// Computes the spheres with the formula of circumsphere.h; the results are equal to the bit. Returns false if
// the formula does not certify some sphere.
bool StarFiller::Lanes::compute_spheres(Point p, double extent) {
  const auto& e = offsets;
  unsigned num_certified = 0;
  for (unsigned i = 0; i < kSize; ++i) {
    const RelativeSphere s = relative_sphere({e[0][i], e[1][i], e[2][i]}, {e[4][i], e[5][i], e[6][i]},
                                             {e[8][i], e[9][i], e[10][i]}, e[3][i], e[7][i], e[11][i]);
    const Point center = p + s.center;
    const double r2 = podm::squared_distance(center, p);
    spheres[0][i] = center.x;
    spheres[1][i] = center.y;
    spheres[2][i] = center.z;
    spheres[3][i] = r2;
    num_certified += static_cast<unsigned>(is_well_conditioned(s.determinant, s.squared_length)) &
                     static_cast<unsigned>(is_certified(r2, extent));
  }
  return num_certified == kSize;
}

void StarFiller::compute_spheres(const Mesh& mesh, const Point& p) {
  collect_offsets();
  for (unsigned first = 0; first < num_facets_; first += Lanes::kSize) {
    Lanes& lanes = lanes_[first / Lanes::kSize];
    if (lanes.compute_spheres(p, mesh.extent())) continue;
    for (unsigned f = first; f < std::min(first + Lanes::kSize, num_facets_); ++f) {
      const auto& v = facets_[f].vertices;
      const Circumsphere s =
          circumsphere(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), p, mesh.extent());
      const std::array<double, 4> words{s.center.x, s.center.y, s.center.z, s.squared_radius};
      for (unsigned k = 0; k < 4; ++k) lanes.spheres[k][f - first] = words[k];
    }
  }
}

void StarFiller::fill(Mesh& mesh, Pool& pool, Region& region, VertexId apex) {
  compute_spheres(mesh, mesh.point(apex));
  pool.replace(region.cells, num_facets_, region.created);
  for (unsigned f = 0; f < num_facets_; ++f) {
    const Facet& facet = facets_[f];
    const CellId id = region.created[f];
    mesh.renew(id, {facet.vertices[0], facet.vertices[1], facet.vertices[2], apex});
    const auto& spheres = lanes_[f / Lanes::kSize].spheres;
    const unsigned lane = f % Lanes::kSize;
    mesh.set_sphere(id, {{spheres[0][lane], spheres[1][lane], spheres[2][lane]}, spheres[3][lane]});
    mesh.set_mirror(facet.mirror, 4 * id + 3);
    const unsigned a = facet.local[0], b = facet.local[1], c = facet.local[2];
    facets_at_edges_.over(b, c) = 4 * id + 0;
    facets_at_edges_.over(c, a) = 4 * id + 1;
    facets_at_edges_.over(a, b) = 4 * id + 2;
  }
  for (unsigned f = 0; f < num_facets_; ++f) {
    const unsigned a = facets_[f].local[0], b = facets_[f].local[1], c = facets_[f].local[2];
    mesh.set_mirrors(region.created[f], {facets_at_edges_.over(c, b), facets_at_edges_.over(a, c),
                                         facets_at_edges_.over(b, a), facets_[f].mirror});
  }
}

}  // namespace podm
