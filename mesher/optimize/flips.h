// Flips around a bad cell: the removal of one of its edges, or of one of its facets together with facets
// beside it.
#pragma once

#include <vector>

#include "optimize/cavity.h"
#include "optimize/edge_removal.h"

namespace podm {

/// The cell of an attempt, and the label of the new cells: the cell's own, or the one that a peel gives it.
/// The cell counts as one of that label.
struct AttemptedCell {
  CellId cell = 0;
  LabelIndex label = kBackground;
  LabelBound bound;  // on new cells

  LabelIndex label_of(const Mesh& mesh, CellId c) const { return c == cell ? label : mesh.label(c); }
};

/// Returns the quality that new cells must exceed if they replace cells of this quality. No new cell is
/// therefore nearly flat: each has enough volume for its sign to be right in rounded arithmetic.
inline double step_over(double quality) { return 1.02 * quality + 1e-4; }

template <class Locks>
class Flips {
 public:
  Flips(const Mesh& mesh, const OptimizationQuality& quality, Cavity<Locks>& cavity)
      : mesh_(mesh), quality_(quality), cavity_(cavity), edge_removal_(quality) {}

  /// Puts the cells around the edge into the cavity, and the vertices around it into ring_. kOutOfReach: the
  /// edge is on an interface, or has too many cells.
  StepResult walk_ring(const AttemptedCell& attempted, unsigned edge);
  /// Finds the flip whose worst new cell is best, puts the cells that it replaces into the cavity and lists
  /// the new cells. kNotBetter: no flip makes better cells.
  StepResult plan_best(const AttemptedCell& attempted);
  const std::vector<LocalCell>& new_cells() const { return new_cells_; }

 private:
  struct Best {
    double quality = 0;
    bool is_edge = false;
    unsigned index = 0;
  };
  // An edge xy of a facet xyz that lies between the same two vertices as the first facet. The cells `over`
  // and `under` share the facet; the next such facet may lie beyond xy.
  struct Side {
    CellId over, under;
    VertexId x, y, z;
    int depth;
  };

  StepResult plan_edge(const AttemptedCell& attempted, unsigned edge);
  StepResult plan_facet(const AttemptedCell& attempted, unsigned facet);
  StepResult plan_side(const AttemptedCell& attempted, const Side& side, double& quality);
  StepResult plan_beyond(const AttemptedCell& attempted, const Side& side, double& quality);
  FacetId beyond(CellId c, VertexId opposite) const;

  const Mesh& mesh_;
  const OptimizationQuality& quality_;
  Cavity<Locks>& cavity_;
  EdgeRemoval edge_removal_;
  Best best_;
  EdgeRing ring_;
  std::vector<LocalCell> new_cells_;
  VertexId top_ = kNoVertex, bottom_ = kNoVertex;  // over and under the facets
  std::vector<VertexId> around_;                   // the vertices around them
  std::vector<CellId> on_facets_;                  // the cells on both sides of the facets
};

extern template class Flips<NoLocks>;
extern template class Flips<VertexLocks>;

}  // namespace podm
