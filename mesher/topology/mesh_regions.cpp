#include "topology/mesh_regions.h"

#include <algorithm>
#include <optional>

#include "topology/disjoint_sets.h"

namespace podm {

class MeshRegionFinder {
 public:
  MeshRegionFinder(const Mesh& mesh, const Affine& to_voxels, MeshRegions& found)
      : mesh_(mesh), to_voxels_(to_voxels), found_(found) {}

  // Until the end, handles are the Euler characteristic of the boundary.
  void operator()() {
    join_cells();
    find_boundary();
    find_fans();
    DisjointSets surfaces(boundary_.size()), cycles(3 * boundary_.size());
    pair_facets(surfaces, cycles);
    connect_cycles(surfaces, cycles);
    for (std::uint32_t h = 0; h < boundary_.size(); ++h)
      if (surfaces.root(h) == h) ++region_of_facet(h).cavities;
    for (MeshRegion& region : found_.regions_) {
      --region.cavities;  // one surface is the outer one
      region.handles = 1 + region.cavities - region.handles / 2;
    }
  }

 private:
  static constexpr std::uint32_t kNone = MeshRegions::kNone;

  bool has_label(CellId c) const { return mesh_.cell(c).is_alive() && mesh_.label(c) != kBackground; }
  // The cell across a facet if it has the label of the facet's own cell, otherwise kNone.
  CellId across(FacetId facet) const {
    const FacetId mirror = mesh_.cell(cell_of(facet)).mirrors[static_cast<unsigned>(index_in_cell(facet))];
    return mirror != kNoFacet && mesh_.label(cell_of(mirror)) == mesh_.label(cell_of(facet)) ? cell_of(mirror)
                                                                                             : kNone;
  }
  MeshRegion& region_of_facet(std::uint32_t h) {
    return found_.regions_[found_.region_of_cell_[cell_of(boundary_[h])]];
  }

  void join_cells() {
    DisjointSets cells(mesh_.cell_bound());
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (!has_label(c)) continue;
      for (unsigned k = 0; k < 4; ++k)
        if (const CellId other = across(4 * c + k); other != kNone && other < c) cells.join(c, other);
    }
    auto& region_of_cell = found_.region_of_cell_;
    region_of_cell.assign(mesh_.cell_bound(), kNone);
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (!has_label(c)) continue;
      const CellId root = cells.root(c);
      if (root == c) {
        region_of_cell[c] = static_cast<std::uint32_t>(found_.regions_.size());
        const Point p = map(to_voxels_, mesh_.point(mesh_.cell(c).vertices[0]));
        found_.regions_.push_back({.label = mesh_.label(c), .first = c, .low = p, .high = p});
      }
      region_of_cell[c] = region_of_cell[root];
      add(c, found_.regions_[region_of_cell[c]]);
    }
  }

  void add(CellId c, MeshRegion& region) const {
    ++region.num_cells;
    for (const VertexId v : mesh_.cell(c).vertices) {
      const Point p = map(to_voxels_, mesh_.point(v));
      region.low = {std::min(region.low.x, p.x), std::min(region.low.y, p.y), std::min(region.low.z, p.z)};
      region.high = {std::max(region.high.x, p.x), std::max(region.high.y, p.y),
                     std::max(region.high.z, p.z)};
    }
  }

  // Lists the boundary facets of all regions, marks their vertices and numbers the cells at these.
  void find_boundary() {
    is_at_boundary_.assign(mesh_.vertex_bound(), 0);
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (!has_label(c)) continue;
      for (unsigned k = 0; k < 4; ++k) {
        if (across(4 * c + k) != kNone) continue;
        boundary_.push_back(4 * c + k);
        for (const int i : kFacetVertices[k])
          is_at_boundary_[mesh_.cell(c).vertices[static_cast<unsigned>(i)]] = 1;
      }
    }
    number_.assign(mesh_.cell_bound(), kNone);
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (!has_label(c)) continue;
      const auto& v = mesh_.cell(c).vertices;
      if (std::any_of(v.begin(), v.end(), [&](VertexId w) { return is_at_boundary_[w] != 0; }))
        number_[c] = num_near_++;
    }
  }

  // A place of a cell: 4 times its number, and the index of a vertex.
  std::uint32_t place(CellId c, VertexId v) const {
    const auto& vertices = mesh_.cell(c).vertices;
    return 4 * number_[c] +
           static_cast<std::uint32_t>(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
  }

  // Joins the places of the cells of each fan, and counts the fans of each region.
  void find_fans() {
    fans_.emplace(4 * static_cast<std::size_t>(num_near_));
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (number_[c] == kNone) continue;
      for (unsigned k = 0; k < 4; ++k) {
        const CellId other = across(4 * c + k);
        if (other == kNone || other > c) continue;
        for (const int i : kFacetVertices[k])
          if (const VertexId v = mesh_.cell(c).vertices[static_cast<unsigned>(i)]; is_at_boundary_[v] != 0)
            fans_->join(place(c, v), place(other, v));
      }
    }
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      if (number_[c] == kNone) continue;
      for (const VertexId v : mesh_.cell(c).vertices)
        if (is_at_boundary_[v] != 0 && fans_->root(place(c, v)) == place(c, v))
          found_.regions_[found_.region_of_cell_[c]].handles += 2;
    }
  }

  // The boundary facet that is next to this one around their common edge, through the region. `beside` is the
  // vertex of the facet that is not on the edge.
  FacetId next_around(FacetId facet, VertexId beside) const {
    const auto index_of = [&](CellId c, VertexId v) {
      const auto& vertices = mesh_.cell(c).vertices;
      return static_cast<unsigned>(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
    };
    for (;;) {
      const CellId c = cell_of(facet);
      const VertexId opposite = mesh_.cell(c).vertices[static_cast<unsigned>(index_in_cell(facet))];
      const FacetId other = 4 * c + index_of(c, beside);  // it contains `opposite`
      if (across(other) == kNone) return other;
      facet = mesh_.cell(c).mirrors[static_cast<unsigned>(index_in_cell(other))];
      beside = opposite;
    }
  }

  std::uint32_t number_of(FacetId facet) const {
    return static_cast<std::uint32_t>(std::lower_bound(boundary_.begin(), boundary_.end(), facet) -
                                      boundary_.begin());
  }
  VertexId vertex_of(std::uint32_t h, unsigned i) const {
    const FacetId facet = boundary_[h];
    return mesh_.cell(cell_of(facet))
        .vertices[static_cast<unsigned>(kFacetVertices[static_cast<unsigned>(index_in_cell(facet))][i])];
  }
  std::uint32_t corner_of(std::uint32_t h, VertexId v) const {
    for (unsigned i = 0; i < 2; ++i)
      if (vertex_of(h, i) == v) return 3 * h + i;
    return 3 * h + 2;
  }

  void pair_facets(DisjointSets& surfaces, DisjointSets& cycles) {
    for (std::uint32_t h = 0; h < boundary_.size(); ++h)
      for (unsigned i = 0; i < 3; ++i) {
        const std::uint32_t other = number_of(next_around(boundary_[h], vertex_of(h, i)));
        surfaces.join(h, other);
        for (const unsigned end : {(i + 1) % 3, (i + 2) % 3})
          cycles.join(3 * h + end, corner_of(other, vertex_of(h, end)));
      }
    std::vector<std::int64_t> facets(found_.regions_.size());
    for (std::uint32_t h = 0; h < boundary_.size(); ++h)
      ++facets[found_.region_of_cell_[cell_of(boundary_[h])]];
    for (std::uint32_t region = 0; region < found_.regions_.size(); ++region)
      found_.regions_[region].handles -= facets[region] / 2;  // F - 3 F / 2
    for (std::uint32_t corner = 0; corner < cycles.size(); ++corner)
      if (cycles.root(corner) == corner) --region_of_facet(corner / 3).handles;
  }

  void connect_cycles(DisjointSets& surfaces, DisjointSets& cycles) {
    std::vector<std::uint32_t> first_of_fan(fans_->size(), kNone);
    for (std::uint32_t corner = 0; corner < cycles.size(); ++corner) {
      if (cycles.root(corner) != corner) continue;
      const std::uint32_t h = corner / 3;
      std::uint32_t& first =
          first_of_fan[fans_->root(place(cell_of(boundary_[h]), vertex_of(h, corner % 3)))];
      if (first == kNone) first = h;
      surfaces.join(first, h);
    }
  }

  const Mesh& mesh_;
  const Affine& to_voxels_;
  MeshRegions& found_;
  std::vector<FacetId> boundary_;  // sorted
  std::vector<char> is_at_boundary_;
  std::vector<std::uint32_t> number_;  // of the cells at vertices of the boundary
  std::uint32_t num_near_ = 0;
  std::optional<DisjointSets> fans_;  // of places
};

MeshRegions::MeshRegions(const Mesh& mesh, const Affine& to_voxels) {
  MeshRegionFinder(mesh, to_voxels, *this)();
}

}  // namespace podm
