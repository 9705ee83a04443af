#include "delaunay/vertex_move.h"

#include <algorithm>

#include "geometry/predicates.h"

namespace podm {

void VertexMove::begin(VertexId v, const HoleFiller& hole) {
  v_ = v;
  moved_.point = mesh_.point(v);  // not the lock word, which other workers read at any time
  moved_.kind = mesh_.vertex(v).kind;
  moved_.sides = mesh_.vertex(v).sides;
  hole.list(mesh_, kFirstPlanned, cells_);
  num_in_hole_ = cells_.size();
  reglued_.clear();
  is_dug_.assign(num_in_hole_, 0);
  border_.clear();
  for (std::size_t i = 0; i < num_in_hole_; ++i)
    for (unsigned k = 0; k < 4; ++k)
      if (const FacetId mirror = cells_[i].mirrors[k]; mirror != kNoFacet && !is_planned(cell_of(mirror)))
        border_.push_back({mirror, static_cast<FacetId>(4 * (kFirstPlanned + i) + k)});
}

void VertexMove::begin_at(const Point& p) {
  moved_.point = p;
  for (const auto& [facet, mirror] : reglued_) planned_mirror(facet) = mirror;
  reglued_.clear();
  cells_.resize(num_in_hole_);
  std::fill(is_dug_.begin(), is_dug_.end(), std::uint8_t{0});
}

FacetId VertexMove::mirror(FacetId f) const {
  if (!is_planned(cell_of(f))) {
    const auto found =
        std::find_if(border_.begin(), border_.end(), [&](const Border& b) { return b.beyond == f; });
    if (found != border_.end()) return found->in_hole;
  }
  return cell(cell_of(f)).mirrors[static_cast<unsigned>(index_in_cell(f))];
}

bool VertexMove::is_in_conflict(CellId c, const Point& p) const {
  if (!is_planned(c)) return mesh_.is_in_conflict(c, p);
  const Cell& of = cell(c);
  const Side side = side_of(of.center, of.squared_radius, p);
  if (side != Side::kUndecided) return side == Side::kInside;
  const auto& v = of.vertices;
  return in_circumsphere(point(v[0]), point(v[1]), point(v[2]), point(v[3]), p);
}

void VertexMove::add_star_facet(FacetId f) {
  const Cell& inside = cell(cell_of(f));
  const auto k = static_cast<unsigned>(index_in_cell(f));
  Cell made;
  for (unsigned i = 0; i < 3; ++i)
    made.vertices[i] = inside.vertices[static_cast<unsigned>(kFacetVertices[k][i])];
  made.vertices[3] = v_;
  made.mirrors = {kNoFacet, kNoFacet, kNoFacet, mirror(f)};
  const auto& v = made.vertices;
  const Circumsphere sphere =
      circumsphere(point(v[0]), point(v[1]), point(v[2]), moved_.point, mesh_.extent());
  made.center = sphere.center;
  made.squared_radius = stored_squared_radius(sphere.squared_radius);
  cells_.push_back(made);
}

void VertexMove::number_star() {
  star_vertices_.clear();
  star_facets_.clear();
  for (std::size_t i = num_in_hole_; i < cells_.size(); ++i) {
    std::array<unsigned, 3>& facet = star_facets_.emplace_back();
    for (unsigned k = 0; k < 3; ++k) {
      const VertexId w = cells_[i].vertices[k];
      Vertex& vertex = mesh_.vertex(w);
      if (vertex.local_index >= star_vertices_.size() || star_vertices_[vertex.local_index] != w) {
        vertex.local_index = static_cast<std::uint16_t>(star_vertices_.size());
        star_vertices_.push_back(w);
      }
      facet[k] = vertex.local_index;
    }
  }
}

void VertexMove::glue_star() {
  relies_.assign(cells_.size(), 0);
  ids_.assign(cells_.size(), 0);  // fill() must not allocate memory
  number_star();
  const FacetsAtEdges::Table at_edges = facets_at_edges_.begin(static_cast<unsigned>(star_vertices_.size()));
  for (CellId c = first_of_star(); c < end(); ++c) {
    const auto& v = star_facets_[c - first_of_star()];
    for (unsigned i = 0; i < 3; ++i) at_edges.over(v[(i + 1) % 3], v[(i + 2) % 3]) = 4 * c + i;
    if (const FacetId beyond = cell(c).mirrors[3]; beyond != kNoFacet && is_planned(cell_of(beyond))) {
      reglued_.push_back({beyond, planned_mirror(beyond)});
      planned_mirror(beyond) = 4 * c + 3;
    }
  }
  for (CellId c = first_of_star(); c < end(); ++c) {
    const auto& v = star_facets_[c - first_of_star()];
    for (unsigned i = 0; i < 3; ++i)
      planned_mirror(4 * c + i) = at_edges.over(v[(i + 2) % 3], v[(i + 1) % 3]);
  }
}

std::size_t VertexMove::num_cells() const {
  const auto num_dug = std::count(is_dug_.begin(), is_dug_.end(), std::uint8_t{1});
  return cells_.size() - static_cast<std::size_t>(num_dug);
}

void VertexMove::fill(Pool& pool, Region& region, VertexId moved) {
  pool.replace(region.cells, num_cells(), region.created);
  auto next = region.created.begin();
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (is_dug(kFirstPlanned + static_cast<CellId>(i))) continue;
    ids_[i] = *next++;
    std::array<VertexId, 4> vertices = cells_[i].vertices;
    std::replace(vertices.begin(), vertices.end(), v_, moved);
    mesh_.renew(ids_[i], vertices);
    mesh_.set_sphere(ids_[i], {cells_[i].center, cells_[i].squared_radius});
    mesh_.set_relies_on_others(ids_[i], relies_[i] != 0);
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (is_dug(kFirstPlanned + static_cast<CellId>(i))) continue;
    std::array<FacetId, 4> mirrors = cells_[i].mirrors;
    for (unsigned k = 0; k < 4; ++k) {
      if (mirrors[k] == kNoFacet) continue;
      if (is_planned(cell_of(mirrors[k]))) {
        mirrors[k] = 4 * ids_[cell_of(mirrors[k]) - kFirstPlanned] + (mirrors[k] & 3u);
      } else {
        mesh_.set_mirror(mirrors[k], 4 * ids_[i] + k);
      }
    }
    mesh_.set_mirrors(ids_[i], mirrors);
  }
}

}  // namespace podm
