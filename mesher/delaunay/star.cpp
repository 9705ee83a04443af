#include "delaunay/star.h"

#include <algorithm>
#include <bit>
#include <cstring>
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
  at_edges_ = facets_at_edges_.begin(num_vertices_);
  return true;
}

// Copies the offsets of four facets at a time: the vectors of a vertex of each, transposed.
void StarFiller::collect_offsets() {
  using Four [[gnu::vector_size(sizeof offsets_[0])]] = double;
  const auto load = [](const auto& from) { return std::bit_cast<Four>(from); };
  // The unused part of the last lanes repeats the last facet.
  const unsigned end = (num_facets_ + Lanes::kSize - 1) / Lanes::kSize * Lanes::kSize;
  std::fill(facets_.begin() + num_facets_, facets_.begin() + end, facets_[num_facets_ - 1]);
  for (unsigned first = 0; first < end; first += 4) {
    auto* const rows = &lanes_[first / Lanes::kSize].offsets[0];
    for (unsigned i = 0; i < 3; ++i) {
      const auto of = [&](unsigned f) { return load(offsets_[facets_[first + f].local[i]]); };
      const Four a = of(0), b = of(1), c = of(2), d = of(3);
      const Four ab_xz = __builtin_shufflevector(a, b, 0, 4, 2, 6),
                 ab_ys = __builtin_shufflevector(a, b, 1, 5, 3, 7),
                 cd_xz = __builtin_shufflevector(c, d, 0, 4, 2, 6),
                 cd_ys = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      const auto put = [&](unsigned k, const Four& row) {
        std::memcpy(&rows[4 * i + k][first % Lanes::kSize], &row, sizeof row);
      };
      put(0, __builtin_shufflevector(ab_xz, cd_xz, 0, 1, 4, 5));
      put(1, __builtin_shufflevector(ab_ys, cd_ys, 0, 1, 4, 5));
      put(2, __builtin_shufflevector(ab_xz, cd_xz, 2, 3, 6, 7));
      put(3, __builtin_shufflevector(ab_ys, cd_ys, 2, 3, 6, 7));
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
  const FacetsAtEdges::Table at_edges = at_edges_;  // a copy stays in registers
  for (unsigned f = 0; f < num_facets_; ++f) {
    const Facet& facet = facets_[f];
    const CellId id = region.created[f];
    mesh.renew(id, {facet.vertices[0], facet.vertices[1], facet.vertices[2], apex});
    const auto& spheres = lanes_[f / Lanes::kSize].spheres;
    const unsigned lane = f % Lanes::kSize;
    mesh.set_sphere(id, {{spheres[0][lane], spheres[1][lane], spheres[2][lane]}, spheres[3][lane]});
    mesh.set_mirror(facet.mirror, 4 * id + 3);
    const auto [a, b, c] = facet.local;
    at_edges.over(b, c) = 4 * id + 0;
    at_edges.over(c, a) = 4 * id + 1;
    at_edges.over(a, b) = 4 * id + 2;
  }
  for (unsigned f = 0; f < num_facets_; ++f) {
    const auto [a, b, c] = facets_[f].local;
    mesh.set_mirrors(region.created[f],
                     {at_edges.over(c, b), at_edges.over(a, c), at_edges.over(b, a), facets_[f].mirror});
  }
}

}  // namespace podm
