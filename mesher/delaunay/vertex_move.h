// The triangulation that would result if one vertex moved. It is planned beside the store, which stays
// unchanged.
//
// Without the vertex its ball is a hole, filled by other cells (hole.h). These cells do not depend on the
// vertex's new place. With the vertex at p, those of them in conflict with p die, and possibly cells beyond
// the hole; the star of p takes their place. Therefore the ball is retriangulated once, and each p costs one
// cavity. The planned cells have ids above all ids of the store, and mirrors in planned and in stored cells.
// cell(), vertex() and label() show the planned cells beside the stored cells that would stay. (Mirrors of
// stored cells that would stay still name cells that would die.)
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/facets_at_edges.h"
#include "delaunay/hole.h"
#include "delaunay/mesh.h"
#include "delaunay/pool.h"
#include "delaunay/region.h"
#include "podm/limits.h"

namespace podm {

class VertexMove {
 public:
  /// The first id of a planned cell.
  static constexpr CellId kFirstPlanned = kMostStoredCells - HoleFiller::kMaxVertices;
  static constexpr bool is_planned(CellId c) { return c >= kFirstPlanned; }
  /// Facet ids do not suffice for more planned cells.
  static constexpr bool has_ids_for(std::size_t num_planned) {
    return num_planned <= kMostStoredCells - kFirstPlanned;
  }

  explicit VertexMove(Mesh& mesh) : mesh_(mesh) {}

  /// Takes v out of its ball, which is the region that `hole` has planned to fill.
  void begin(VertexId v, const HoleFiller& hole);
  VertexId vertex() const { return v_; }

  // ---- The cavity of a point, dug by Operation::plan_move_to ----

  /// Starts the plan for the vertex at p: no planned cell is in the cavity, and there is no star.
  void begin_at(const Point& p);
  /// True if the planned cell is in the cavity.
  bool is_dug(CellId c) const { return c < first_of_star() && is_dug_[c - kFirstPlanned] != 0; }
  void dig(CellId c) { is_dug_[c - kFirstPlanned] = 1; }
  /// Returns the other side of a facet of any cell, once the vertex is taken out.
  FacetId mirror(FacetId f) const;
  /// Adds a new cell over f, a facet of a cell in the cavity that bounds the cavity.
  void add_star_facet(FacetId f);

  // ---- The planned cells ----

  const Point& point() const { return moved_.point; }
  VertexKind kind() const { return moved_.kind; }
  SideMask sides() const { return moved_.sides; }
  /// Ids of the cells around p. They have no mirrors to each other before glue_star().
  CellId first_of_star() const { return kFirstPlanned + static_cast<CellId>(num_in_hole_); }
  CellId end() const { return kFirstPlanned + static_cast<CellId>(cells_.size()); }
  /// Sets the mirrors of the star's cells, and of the hole's cells that are not dug.
  void glue_star();

  /// Sets the future value of Mesh::relies_on_others for a planned cell, once the star is glued.
  void set_relies_on_others(CellId c, bool relies_on_others) {
    relies_[c - kFirstPlanned] = relies_on_others;
  }

  std::size_t num_cells() const;
  /// Replaces the region by the planned cells, once the star is glued. `moved` is the vertex's id there.
  void fill(Pool& pool, Region& region, VertexId moved);

  // ---- The interface of a mesh ----

  const Cell& cell(CellId c) const { return is_planned(c) ? cells_[c - kFirstPlanned] : mesh_.cell(c); }
  const Vertex& vertex(VertexId v) const { return v == v_ ? moved_ : mesh_.vertex(v); }
  const Point& point(VertexId v) const { return vertex(v).point; }
  LabelIndex& label(CellId c) { return is_planned(c) ? cells_[c - kFirstPlanned].label : mesh_.label(c); }
  bool is_in_conflict(CellId c, const Point& p) const;

 private:
  struct Border {
    FacetId beyond, in_hole;
  };

  FacetId& planned_mirror(FacetId f) {
    return cells_[cell_of(f) - kFirstPlanned].mirrors[static_cast<unsigned>(index_in_cell(f))];
  }

  void number_star();

  Mesh& mesh_;
  VertexId v_ = kNoVertex;
  Vertex moved_;             // the vertex at its new place
  std::vector<Cell> cells_;  // cells of the hole, then of the star
  std::size_t num_in_hole_ = 0;
  std::vector<std::uint8_t> is_dug_, relies_;
  std::vector<Border> border_;
  std::vector<std::array<FacetId, 2>> reglued_;  // facets of the hole's cells, and their earlier mirrors
  std::vector<VertexId> star_vertices_;
  std::vector<std::array<unsigned, 3>> star_facets_;  // per star cell, its vertices except v, numbered
  FacetsAtEdges facets_at_edges_;
  std::vector<CellId> ids_;  // scratch of fill(): ids of the planned cells in the store
};

}  // namespace podm
