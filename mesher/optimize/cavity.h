// A cavity: cells that optimisation replaces by others with the same boundary. The Delaunay property is given
// up; that all cells are positive is not: positive cells whose boundary is that of the cavity cover it once,
// since a point's number of cells changes at a facet of the boundary alone.
//
// As an operation of refinement (delaunay/operation.h) it is cautious: all vertices of all cells that it has
// are locked before it writes anything, and memory is asked for before that too. A point is read under its
// vertex's lock alone. A vertex that moves is a new one: the old one goes with all the cells around it.
// So the argument of delaunay/vertex_locks.h holds for cavities, but for the Delaunay property. Labels stay
// as they are unless a cell is replaced, and so nobody but the holder of all its locks writes one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "delaunay/pool.h"
#include "delaunay/vertex_locks.h"
#include "optimize/cell_quality.h"

namespace podm {

/// A vertex of a cavity by its number there, and a cell by those of its vertices.
using Local = std::uint8_t;
using LocalCell = std::array<Local, 4>;
using LocalFacet = std::array<Local, 3>;

/// The facet opposite vertex k, counter-clockwise seen from there.
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

  /// Locks two vertices of the cell c of that stamp, so that it and its neighbours may be read. kStaleCell:
  /// it has died. Unless done nothing is held.
  StepResult reserve(CellId c, std::uint32_t stamp);
  void release();
  const Locks& locks() const { return locks_; }

  /// No cells; what is locked stays so.
  void clear();
  /// Adds a cell that may be read, and locks its vertices. kTooNear: it has too many vertices.
  StepResult add(CellId c);
  /// Adds all cells around a vertex of the cell `seed`. They have `label` all, or kOutOfReach: then the
  /// vertex is on an interface, and some are added.
  StepResult add_ball(VertexId v, CellId seed, LabelIndex label);
  /// Adds a vertex that is no one's yet.
  Local add_point(const Point& p);

  std::size_t num_cells() const { return cells_.size(); }
  CellId cell(std::size_t i) const { return cells_[i]; }
  const LocalCell& vertices(std::size_t i) const { return vertices_[i]; }
  bool has(CellId c) const;
  std::size_t num_vertices() const { return ids_.size(); }
  const Point& point(Local v) const { return points_[v]; }
  const std::vector<Point>& points() const { return points_; }
  /// The number of a vertex that it has.
  Local local_of(VertexId v) const { return static_cast<Local>(mesh_.vertex(v).local_index); }
  bool has_vertex(VertexId v) const;
  CellPoints points_of(const LocalCell& c) const {
    return {points_[c[0]], points_[c[1]], points_[c[2]], points_[c[3]]};
  }
  /// The quality of its worst cell.
  double worst(const CellQuality& quality) const;
  /// Facets of its cells whose other side stays, each counter-clockwise seen from inside.
  void collect_boundary(std::vector<LocalFacet>& facets) const;

  /// Puts `cells`, of that label, in its place. They must be positive; vertices that none of them has are
  /// removed, and points that were added become vertices of that kind, one at most. Throws InternalError,
  /// with nothing written, when they have another boundary, and std::bad_alloc likewise.
  void replace_by(const std::vector<LocalCell>& cells, LabelIndex label, VertexKind kind);
  /// What the last replacement made.
  const std::vector<CellId>& created() const { return created_; }
  std::int64_t net_cells() const { return net_cells_; }

 private:
  struct FacetSide {
    std::uint32_t key;    // the facet's vertices, sorted
    std::uint32_t facet;  // 4 * number of a new cell + index, or of outer_
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
