// A cavity: cells that optimisation replaces by other cells with the same boundary. The Delaunay property is
// given up, but all cells stay positive. Positive cells whose boundary is that of the cavity cover it once,
// because the number of cells that contain a point changes only at a facet of the boundary.
//
// Like an operation of refinement (delaunay/operation.h) it is cautious: all vertices of all its cells are
// locked before anything is written, and memory is requested before that, too. A point is read only under its
// vertex's lock. A vertex that moves becomes a new vertex: the old one is removed with all cells around it.
// The argument of delaunay/vertex_locks.h therefore holds for cavities, except for the Delaunay property. A
// label changes only when its cell is replaced, so only the worker that holds all locks of the cell writes
// it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "delaunay/pool.h"
#include "delaunay/vertex_locks.h"
#include "optimize/optimization_quality.h"

namespace podm {

/// The number of a vertex in a cavity, and a cell and a facet as the numbers of their vertices.
using Local = std::uint8_t;
using LocalCell = std::array<Local, 4>;
using LocalFacet = std::array<Local, 3>;

/// Returns the facet opposite vertex k, counter-clockwise seen from there.
inline LocalFacet facet_of(const LocalCell& cell, unsigned k) {
  const auto& turn = kFacetVertices[k];
  return {cell[static_cast<unsigned>(turn[0])], cell[static_cast<unsigned>(turn[1])],
          cell[static_cast<unsigned>(turn[2])]};
}

template <class Locks>
class Cavity {
 public:
  static constexpr std::size_t kMaxVertices = 128;

  Cavity(Mesh& mesh, Pool& pool, WorkerId self) : mesh_(mesh), pool_(pool), locks_(self) {}

  /// Locks two vertices of the cell c of that stamp, so that it and its neighbors may be read. kStaleCell:
  /// the cell has died. Unless the result is kDone, no lock is held.
  StepResult reserve(CellId c, std::uint32_t stamp);
  void release();
  const Locks& locks() const { return locks_; }

  /// Removes all cells from the cavity. Locks are kept.
  void clear();
  /// Adds a cell that may be read, and locks its vertices. kTooNear: the cavity has too many vertices.
  StepResult add(CellId c);
  /// Adds all cells around a vertex of the cell `seed`. kOutOfReach: not all of them have `label`, so the
  /// vertex is on an interface; some cells have been added.
  StepResult add_ball(VertexId v, CellId seed, LabelIndex label);
  /// Adds a point that is not yet a vertex of the mesh.
  Local add_point(const Point& p);

  std::size_t num_cells() const { return cells_.size(); }
  CellId cell(std::size_t i) const { return cells_[i]; }
  const LocalCell& vertices(std::size_t i) const { return vertices_[i]; }
  bool has(CellId c) const;
  std::size_t num_vertices() const { return ids_.size(); }
  const Point& point(Local v) const { return points_[v]; }
  const std::vector<Point>& points() const { return points_; }
  /// Returns the number of a vertex that the cavity has.
  Local local_of(VertexId v) const { return static_cast<Local>(mesh_.vertex(v).local_index); }
  bool has_vertex(VertexId v) const;
  CellPoints points_of(const LocalCell& c) const {
    return {points_[c[0]], points_[c[1]], points_[c[2]], points_[c[3]]};
  }
  /// Returns the quality of the cavity's worst cell.
  double worst(const OptimizationQuality& quality) const;
  /// Lists the facets of the cavity's cells whose other side stays, each counter-clockwise seen from inside.
  void collect_boundary(std::vector<LocalFacet>& facets) const;

  /// Replaces the cavity by `cells` with that label. The cells must be positive. Vertices that none of them
  /// has are removed. Points that were added, at most one, become vertices of that kind. Throws InternalError
  /// if the cells have another boundary, or std::bad_alloc; then nothing is written.
  void replace_by(const std::vector<LocalCell>& cells, LabelIndex label, VertexKind kind);
  /// The cells that the last replacement made.
  const std::vector<CellId>& created() const { return created_; }
  std::int64_t net_cells() const { return net_cells_; }

 private:
  struct FacetSide {
    std::uint32_t key;    // the facet's vertices, sorted
    std::uint32_t facet;  // 4 * number of a new cell + index, or position in outer_
    bool is_outer;
  };

  void match(const std::vector<LocalCell>& cells);
  void number(VertexId v);

  Mesh& mesh_;
  Pool& pool_;
  Locks locks_;
  std::vector<CellId> cells_, created_;
  std::vector<LocalCell> vertices_;
  std::vector<VertexId> ids_;
  std::vector<Point> points_;
  std::vector<FacetSide> sides_;
  std::vector<FacetId> outer_;
  std::vector<CellId> ball_;
  std::int64_t net_cells_ = 0;
};

extern template class Cavity<NoLocks>;
extern template class Cavity<VertexLocks>;

}  // namespace podm
