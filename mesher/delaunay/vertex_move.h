// What the triangulation would be if one vertex moved: planned beside the store, in which nothing is written.
//
// Without the vertex its ball is a hole, filled by other cells (hole.h); these are the same wherever it goes.
// With the vertex at p those in conflict with p die, and maybe cells beyond the hole; the star of p takes
// their place. So the ball is retriangulated once, and each p costs a cavity. The cells so planned have ids
// above all of the store's and mirrors of both kinds: whoever asks cell(), vertex() and label() sees them
// beside those cells of the store that would stay. (Mirrors of the latter still name cells that would die.)
#pragma once

#include <array>
#include <cstdint>
#include <span>
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
  /// Planned cells have ids from this on.
  static constexpr CellId kFirstPlanned = kMostStoredCells - HoleFiller::kMaxVertices;
  static constexpr bool is_planned(CellId c) { return c >= kFirstPlanned; }
  /// Of more planned cells facets would have no numbers.
  static constexpr bool has_ids_for(std::size_t num_planned) {
    return num_planned <= kMostStoredCells - kFirstPlanned;
  }

  explicit VertexMove(Mesh& mesh) : mesh_(mesh) {}

  /// Takes v out of its ball, the region that `hole` has planned to fill.
  void begin(VertexId v, const HoleFiller& hole);
  VertexId vertex() const { return v_; }

  // ---- The cavity of a point, dug by Operation::plan_move_to ----

  /// The vertex is to be at p: no planned cell is in the cavity, and there is no star.
  void begin_at(const Point& p);
  /// Whether the planned cell is in the cavity.
  bool is_dug(CellId c) const { return c < first_of_star() && is_dug_[c - kFirstPlanned] != 0; }
  void dig(CellId c) { is_dug_[c - kFirstPlanned] = 1; }
  /// What is on the other side of a facet of any cell, once the vertex is taken out.
  FacetId mirror(FacetId f) const;
  /// The facet f of a cell in the cavity bounds it: there is a new cell over it.
  void add_star_facet(FacetId f);

  // ---- What is planned ----

  const Point& point() const { return moved_.point; }
  VertexKind kind() const { return moved_.kind; }
  /// Ids of the cells around p, without mirrors to each other until glue_star().
  CellId first_of_star() const { return kFirstPlanned + static_cast<CellId>(num_in_hole_); }
  CellId end() const { return kFirstPlanned + static_cast<CellId>(cells_.size()); }
  /// Makes their mirrors right, and those of the hole's cells that are not dug.
  void glue_star();

  /// Tells of a planned cell, once the star is glued, what Mesh::relies_on_others is to be.
  void tell_reliance(CellId c, bool relies_on_others) { relies_[c - kFirstPlanned] = relies_on_others; }

  std::size_t num_cells() const;
  /// Replaces the region by the planned cells, once the star is glued. The vertex is called `moved` there.
  void fill(Pool& pool, Region& region, VertexId moved);

  // ---- As of a mesh ----

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
  Vertex moved_;             // as it would be
  std::vector<Cell> cells_;  // of the hole, then of the star
  std::size_t num_in_hole_ = 0;
  std::vector<std::uint8_t> is_dug_, relies_;
  std::vector<Border> border_;
  std::vector<std::array<FacetId, 2>> reglued_;  // facets of the hole's cells, and their mirrors before
  std::vector<VertexId> star_vertices_;
  std::vector<std::array<unsigned, 3>> star_facets_;  // each star cell's vertices but v, numbered
  FacetsAtEdges facets_at_edges_;
  std::vector<CellId> ids_;  // scratch of fill(): those that planned cells get
};

}  // namespace podm
