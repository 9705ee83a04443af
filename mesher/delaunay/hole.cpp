#include "delaunay/hole.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/predicates.h"
#include "podm/errors.h"

namespace podm {

namespace {

std::uint64_t key_of(std::array<std::uint16_t, 3> local) {
  if (local[0] > local[1]) std::swap(local[0], local[1]);
  if (local[1] > local[2]) std::swap(local[1], local[2]);
  if (local[0] > local[1]) std::swap(local[0], local[1]);
  return (static_cast<std::uint64_t>(local[0]) << 32 | static_cast<std::uint64_t>(local[1]) << 16 |
          local[2]) +
         1;
}

}  // namespace

HoleFiller::Local HoleFiller::add_local(VertexId v, const Point& p) {
  ids_.push_back(v);
  points_.push_back(p);
  return static_cast<Local>(ids_.size() - 1);
}

HoleFiller::Local HoleFiller::local_of(Mesh& mesh, VertexId v) {
  Vertex& vertex = mesh.vertex(v);
  if (vertex.local_index >= ids_.size() || ids_[vertex.local_index] != v)
    vertex.local_index = add_local(v, vertex.point);
  return vertex.local_index;
}

// Returns false if there are too many vertices. The vertices of the boundary are among those of the cells.
bool HoleFiller::collect(Mesh& mesh, const Region& region, const Point* added) {
  ids_.clear();
  points_.clear();
  open_.clear();
  is_closed_.clear();
  cells_.clear();
  glued_.clear();
  rebuild_table(8 * (region.boundary.size() + region.cells.size()));
  for (const CellId c : region.cells) {
    for (const VertexId v : mesh.cell(c).vertices) {
      if (std::find(region.removed.begin(), region.removed.end(), v) == region.removed.end())
        local_of(mesh, v);
    }
    if (ids_.size() >= max_vertices_) return false;  // keeps room for the added vertex
  }
  added_ = added != nullptr ? add_local(kNoVertex, *added) : kNoApex;
  for (const FacetId f : region.boundary) {
    const Cell& cell = mesh.cell(cell_of(f));
    const auto k = static_cast<unsigned>(index_in_cell(f));
    OpenFacet facet{{}, {cell.mirrors[k], false}};
    for (unsigned i = 0; i < 3; ++i) {
      facet.local[i] = local_of(mesh, cell.vertices[static_cast<unsigned>(kFacetVertices[k][i])]);
    }
    add_or_match(facet);
  }
  return true;
}

bool HoleFiller::plan(Mesh& mesh, const Region& region, const Point* added) {
  if (!collect(mesh, region, added)) return false;
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (is_closed_[i]) continue;
    const OpenFacet facet = open_[i];
    is_closed_[i] = 1;
    const auto first = static_cast<FacetId>(4 * cells_.size());
    const std::array<Local, 4> local{facet.local[0], facet.local[1], facet.local[2], apex_of(mesh, facet)};
    cells_.push_back(local);
    glued_.push_back({facet.other, FacetRef{first + 3, true}});
    for (unsigned k = 0; k < 3; ++k) {
      const auto& turn = kFacetVertices[k];  // seen from the new cell; the hole sees the reverse order
      add_or_match({{local[static_cast<unsigned>(turn[0])], local[static_cast<unsigned>(turn[2])],
                     local[static_cast<unsigned>(turn[1])]},
                    {first + k, true}});
    }
  }
  return true;
}

void HoleFiller::fill(Mesh& mesh, Pool& pool, Region& region, VertexId added) {
  const auto id_of = [&](Local local) { return ids_[local] != kNoVertex ? ids_[local] : added; };
  pool.replace(region.cells, cells_.size(), region.created);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto& local = cells_[i];
    const CellId id = region.created[i];
    mesh.renew(id, {id_of(local[0]), id_of(local[1]), id_of(local[2]), id_of(local[3])});
    mesh.refresh_sphere(id);
  }
  const auto facet_of = [&](FacetRef f) {
    return f.is_planned ? 4 * region.created[f.facet >> 2] + (f.facet & 3) : f.facet;
  };
  for (const auto& [a, b] : glued_) {
    mesh.set_mirror(facet_of(a), facet_of(b));
    mesh.set_mirror(facet_of(b), facet_of(a));
  }
}

void HoleFiller::list(const Mesh& mesh, CellId first, std::vector<Cell>& cells) const {
  cells.assign(cells_.size(), Cell{});
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto& [a, b, c, d] = cells_[i];
    cells[i].vertices = {ids_[a], ids_[b], ids_[c], ids_[d]};
    const Circumsphere sphere = circumsphere(points_[a], points_[b], points_[c], points_[d], mesh.extent());
    cells[i].center = sphere.center;
    cells[i].squared_radius = stored_squared_radius(sphere.squared_radius);
  }
  const auto facet_of = [&](FacetRef f) { return f.is_planned ? 4 * first + f.facet : f.facet; };
  for (const auto& [a, b] : glued_) {
    if (a.is_planned) cells[cell_of(a.facet)].mirrors[static_cast<unsigned>(a.facet & 3)] = facet_of(b);
    if (b.is_planned) cells[cell_of(b.facet)].mirrors[static_cast<unsigned>(b.facet & 3)] = facet_of(a);
  }
}

// A facet that is seen for the second time closes the hole there: its two sides are glued.
void HoleFiller::add_or_match(const OpenFacet& facet) {
  if (4 * (used_slots_ + 1) > 3 * table_.size()) throw InternalError("gift wrapping does not close");
  const std::uint64_t key = key_of(facet.local);
  Slot& slot = slot_of(key);
  if (slot.key == 0) {
    slot = {key, static_cast<std::uint32_t>(open_.size())};
    ++used_slots_;
    open_.push_back(facet);
    is_closed_.push_back(0);
    return;
  }
  if (is_closed_[slot.open]) throw InternalError("gift wrapping met a facet three times");
  is_closed_[slot.open] = 1;
  glued_.push_back({facet.other, open_[slot.open].other});
}

HoleFiller::Slot& HoleFiller::slot_of(std::uint64_t key) {
  std::size_t i = (key * 0x9e3779b97f4a7c15ull) >> 40;
  for (;; ++i) {
    Slot& slot = table_[i & (table_.size() - 1)];
    if (slot.key == 0 || slot.key == key) return slot;
  }
}

void HoleFiller::rebuild_table(std::size_t size) {
  std::size_t power = 256;
  while (power < size) power *= 2;
  table_.assign(power, Slot{});
  used_slots_ = 0;
}

bool HoleFiller::is_inner(const OpenFacet& facet, std::size_t i) const {
  const auto& [a, b, c] = facet.local;
  return i != a && i != b && i != c && orientation(points_[a], points_[b], points_[c], points_[i]) > 0;
}

// Finds, in rounded arithmetic, the candidate on the inner side whose sphere with the facet has the lowest
// center along the facet's axis.
unsigned HoleFiller::nearest_apex(const OpenFacet& facet) const {
  const Point& a = points_[facet.local[0]];
  const Vector ab = points_[facet.local[1]] - a, ac = points_[facet.local[2]] - a;
  const Vector normal = cross(ab, ac);
  const double n2 = squared_length(normal);
  // The foot of the axis, relative to a.
  const Vector foot =
      (0.5 / n2) * (squared_length(ab) * cross(ac, normal) + squared_length(ac) * cross(normal, ab));
  // |ab|,|ac|,|x-a| times 16 u bounds the rounding of dot(normal, x-a) (each product of three differences).
  const double bound = 16 * 0x1p-53 * std::sqrt(squared_length(ab) * squared_length(ac));
  unsigned best = kNoApex;
  double best_height = std::numeric_limits<double>::infinity();
  for (unsigned i = 0; i < points_.size(); ++i) {
    if (i == facet.local[0] || i == facet.local[1] || i == facet.local[2]) continue;
    const Vector x = points_[i] - a;
    const double side = dot(normal, x);
    const double s = squared_length(x);
    if (side * side <= bound * bound * s) {
      if (!is_inner(facet, i)) continue;
    } else if (side < 0) {
      continue;
    }
    const double height = (s - 2 * dot(foot, x)) / side;
    if (best == kNoApex || height < best_height) {
      best = i;
      best_height = height;
    }
  }
  return best;
}

HoleFiller::Local HoleFiller::apex_of(const Mesh& mesh, const OpenFacet& facet) {
  // Most cells of the hole have the added vertex: for all facets without it, it is tried first.
  unsigned best = added_ != kNoApex && is_inner(facet, added_) ? added_ : nearest_apex(facet);
  if (best == kNoApex) throw InternalError("no vertex on the inner side of a hole's facet");
  // The guess is now proved, or replaced by a vertex inside its sphere. Spheres through the facet are nested
  // on its inner side, so each replacement shrinks the set of vertices inside. Therefore one pass over all
  // candidates ends with the apex.
  const Point &a = points_[facet.local[0]], &b = points_[facet.local[1]], &c = points_[facet.local[2]];
  Circumsphere sphere = circumsphere(a, b, c, points_[best], mesh.extent());
  for (unsigned i = 0; i < points_.size(); ++i) {
    const Side side = side_of(sphere, points_[i]);
    if (side == Side::kOutside || i == best || !is_inner(facet, i)) continue;
    if (side == Side::kUndecided && !in_circumsphere(a, b, c, points_[best], points_[i])) continue;
    best = i;
    sphere = circumsphere(a, b, c, points_[best], mesh.extent());
  }
  return static_cast<Local>(best);
}

}  // namespace podm
