// Test helper: triangulates given points one by one, finding each point's first conflict by scanning.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "cells_by_points.h"
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
  void remove(VertexId v) {
    operation.plan_removal(v, cell_around(v));
    operation.commit_removals();
  }
  auto cells() const { return cells_by_points(mesh); }

  Mesh mesh;
  Pool pool;
  Operation<NoLocks> operation;
};

}  // namespace podm::test
