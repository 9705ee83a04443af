// Flips around a bad cell: the removal of one of its edges, or of one of its facets together with those
// beside it.
#pragma once

#include <limits>
#include <vector>

#include "optimize/cavity.h"
#include "optimize/edge_removal.h"

namespace podm {

/// The cell that an attempt is about, and the label that new cells get: its own, or the one that a peel gives
/// it. It counts as one of that label.
struct Subject {
  CellId cell = 0;
  LabelIndex label = kBackground;
  LabelBound bound;  // on new cells

  LabelIndex label_of(const Mesh& mesh, CellId c) const { return c == cell ? label : mesh.label(c); }
};

/// What a step makes of a quality: whoever replaces cells of this quality has to make better ones. So no new
/// cell is nearly flat: each has volume enough for its sign to be right in rounded arithmetic.
inline double step_over(double quality) { return 1.02 * quality + 1e-4; }

template <class Locks>
class Flips {
 public:
  Flips(const Mesh& mesh, const CellQuality& quality, Cavity<Locks>& cavity)
      : mesh_(mesh), quality_(quality), cavity_(cavity), edge_removal_(quality) {}

  /// The cavity becomes the cells around the edge, and ring() those around it. kOutOfReach: the edge is on an
  /// interface, or has too many cells.
  StepResult walk_ring(const Subject& subject, unsigned edge);
  /// Finds the flip whose worst new cell is best, puts what it replaces into the cavity and lists the new
  /// cells. kNotBetter: no flip makes better cells.
  StepResult plan_best(const Subject& subject);
  const std::vector<LocalCell>& new_cells() const { return new_cells_; }

 private:
  struct Best {
    double quality = 0;
    bool is_edge = false;
    unsigned index = 0;
  };
  // Facets between the same two vertices, over one edge of which the next lies: cells `over` and `under` it
  // share the facet of the edge xy and z.
  struct Side {
    CellId over, under;
    VertexId x, y, z;
    int depth;
  };

  StepResult plan_edge(const Subject& subject, unsigned edge);
  StepResult plan_facet(const Subject& subject, unsigned facet);
  StepResult plan_side(const Subject& subject, const Side& side, double& quality);
  StepResult plan_beyond(const Subject& subject, const Side& side, double& quality);
  FacetId beyond(CellId c, VertexId opposite) const;

  const Mesh& mesh_;
  const CellQuality& quality_;
  Cavity<Locks>& cavity_;
  EdgeRemoval edge_removal_;
  Best best_;
  EdgeRing ring_;
  std::vector<LocalCell> new_cells_;
  VertexId top_ = kNoVertex, bottom_ = kNoVertex;  // over and under the facets
  std::vector<VertexId> around_;                   // the vertices around them
  std::vector<CellId> on_facets_;                  // the cells on both sides of them
};

extern template class Flips<NoLocks>;
extern template class Flips<VertexLocks>;

}  // namespace podm
