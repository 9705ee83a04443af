// Test helper: triangulates given points one by one, and finds each point's first conflict by scanning.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "cells_by_points.h"
#include "delaunay/hole.h"
#include "delaunay/operation.h"

namespace podm::test {

class Triangulator {
 public:
  explicit Triangulator(const Box& box, std::size_t capacity = 1 << 20)
      : mesh(box, capacity), pool(mesh), operation(mesh, pool, 0) {}

  CellId conflicting_cell(const Point& p) const {
    for (CellId c = mesh.cell_bound(); c-- > 0;) {
      if (mesh.cell(c).is_alive() && mesh.is_in_conflict(c, p)) return c;
    }
    throw std::runtime_error("point outside the box");
  }
  std::optional<VertexId> insert(const Point& p, VertexKind kind = VertexKind::kCircumcenter) {
    operation.plan_insertion(p, conflicting_cell(p));
    if (operation.commit_insertion(p, kind, 1e-100) != StepResult::kDone) {
      operation.rollback();
      return std::nullopt;
    }
    return operation.inserted();
  }
  CellId cell_around(VertexId v) const {
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      const auto& cell = mesh.cell(c);
      if (cell.is_alive() && std::count(cell.vertices.begin(), cell.vertices.end(), v) > 0) return c;
    }
    throw std::runtime_error("vertex in no cell");
  }
  /// Returns the cells that `is_of_it(CellId)` selects, marked, with their boundary.
  template <class Predicate>
  Region region_of(const Predicate& is_of_it) {
    Region region;
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      if (!mesh.cell(c).is_alive() || !is_of_it(c)) continue;
      region.cells.push_back(c);
      mesh.mark(c, true);
    }
    for (const CellId c : region.cells) {
      for (unsigned k = 0; k < 4; ++k) {
        const FacetId mirror = mesh.cell(c).mirrors[k];
        if (mirror == kNoFacet || !mesh.is_marked(cell_of(mirror))) region.boundary.push_back(4 * c + k);
      }
    }
    return region;
  }
  /// Removes v and inserts nothing in its place. No operation of the mesher does this.
  void remove(VertexId v) {
    Region region = region_of([&](CellId c) {
      const auto& vertices = mesh.cell(c).vertices;
      return std::find(vertices.begin(), vertices.end(), v) != vertices.end();
    });
    region.removed = {v};
    HoleFiller hole;
    if (!hole.plan(mesh, region, nullptr)) throw std::runtime_error("a hole of too many vertices");
    pool.reserve(region.cells, hole.num_cells(), 1);
    hole.fill(mesh, pool, region, kNoVertex);
    pool.release_vertex(v);
  }
  auto cells() const { return cells_by_points(mesh); }

  Mesh mesh;
  Pool pool;
  Operation<NoLocks> operation;
};

}  // namespace podm::test
