// Rule R7: a cell inside the object with a dihedral angle out of bounds is poor. One of its vertices moves if
// that improves the angles around the vertex and violates no rule. R7 runs last, on a mesh that violates no
// other rule.
//
// (CGAL's perturbation moves vertices of slivers, too: Tournois, Srinivasan, Alliez, "Perturbing slivers in
// 3D Delaunay meshes", IMR 2009. It gives up ratio and facet angles.)
//
// A move is one operation: the vertex is removed and inserted elsewhere, and the cells are the Delaunay
// triangulation again. The move is planned (delaunay/vertex_move.h), and committed if
//   (i)   all planned cells inside the object have a quality (geometry/dihedral.h) of 1, or of kQualityStep
//         more than the least among the cells that they replace,
//   (ii)  no planned cell violates R1 to R5, and no other cell does, and
//   (iii) the vertex keeps the distances of I1 to I3 (rules.h) from all others, with s in place of m.
// The cells that stay obey R2 to R5: these rules depend on a cell and its neighbors, and the dual edge of a
// facet changes only with one of the facet's cells. R1 depends on isosurface vertices, which stay when a free
// vertex moves. An isosurface vertex moves to another point of the isosurface, and may uncover samples of
// cells that stay. Such a sample lies within delta of the vertex's old position and in the ball of its cell.
// The cell is therefore among the cells whose balls reach into the ball of radius delta around the old
// position. Among these cells, a cell whose sample is covered by one of its own vertices keeps that vertex.
// The other cells, as marked by their last examination (Mesh::relies_on_others), are examined again.
// Therefore all guarantees of R1 to R6 hold after each move as they did before it.
//
// R7 terminates. Let n_i be the number of poor cells inside the object with a quality from i to i + 1 times
// kQualityStep. If i is the lowest class among the cells that a move replaces, the move makes no cell of
// class i or lower, and n_i falls. The tuple (n_0, n_1, ...) therefore falls in lexicographic order, and
// there is no infinite falling sequence of such finite tuples of natural numbers. Apart from moves, each poor
// cell is tried once in each of a few rounds.
//
// Workers apply R7 concurrently, as they apply R1 to R6, and for the same reasons (delaunay/vertex_locks.h).
// All vertices of the cells that a move replaces are locked before anything is written. Two vertices are
// locked of each cell that is examined, or read in addition: the cell does not change until the move is over,
// and a worker that changes it later sees the move. The examination of a planned cell, or of a cell that
// stays, depends only on vertices of such cells and of their neighbors. Could two moves each rely on a vertex
// that the other takes away? The first move relies on it as a vertex of a cell of which it has locked two
// vertices, or of a neighbor of such a cell. The second move replaces all cells around the vertex, so it
// holds all their vertices. A lock has one holder, so this cannot be. Therefore the moves of any run are
// those of some serial run in which each move is as above, and they end.
//
// Ranks apply R7 in zones (distributed/zone.h), for the same reason. A move holds the vertices in its zone,
// and a cell that it reads has a vertex there. A neighbour of that cell has one, too. A move in another zone
// replaces only cells without such a vertex. The cells beyond the vertex's ball, and those beyond the cavity
// of its new place, are read as well; a move ends if one of them is not known to be a cell of the whole.
#pragma once

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "delaunay/cell_list.h"
#include "delaunay/operation.h"
#include "geometry/dihedral.h"
#include "podm/bounds.h"
#include "podm/perturbation_report.h"
#include "refine/dihedral_quality.h"
#include "refine/move_judge.h"
#include "refine/move_points.h"
#include "refine/rules.h"

namespace podm {

/// A step of DihedralBounds::quality, which is squared.
inline constexpr double kQualityStep = 0.05;

template <class Locks>
class Perturbation {
 public:
  /// Keeps all references. `seed` seeds the random points.
  Perturbation(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters, const Rules& rules,
               Operation<Locks>& operation, const DihedralBounds& bounds, std::uint64_t seed,
               const std::optional<CountedReads>& reads)
      : mesh_(mesh),
        rules_(rules),
        operation_(operation),
        bounds_(bounds),
        judge_(operation.move(), isosurface, parameters, bounds_, operation.counters(), reads),
        random_(seed) {}

  /// True if the cell is inside the object and has an angle out of bounds.
  bool is_poor(CellId c) const { return podm::is_poor(mesh_, rules_, c, bounds_); }
  /// Sets the effort for the next cells.
  void set_effort(const MoveEffort& effort) { effort_ = effort; }
  /// Plans a move that improves a poor cell. kDone: the caller is to commit the move to move().point().
  /// kNoMove: no move is accepted; obstacle() gives the reason. Unless the result is kDone the caller must
  /// roll back.
  StepResult plan(CellId poor);
  Unmoved obstacle() const { return obstacle_; }

 private:
  struct Candidate {
    Point point;
    double quality;
  };

  StepResult plan_of(VertexId v, CellId poor);
  void begin(VertexId v, CellId poor);
  double least_quality_in_region(std::size_t first);
  std::optional<Point> next_point();
  StepResult try_point(const Point& p, double in_ball);
  StepResult obeys_rules();
  StepResult obeys_rules(CellId planned);
  StepResult is_covered(const Point& z, CellId start);
  StepResult keeps_samples_covered();
  StepResult choose();

  Mesh& mesh_;
  const Rules& rules_;
  Operation<Locks>& operation_;
  const DihedralBounds bounds_;
  MoveJudge judge_;
  std::mt19937_64 random_;
  MoveEffort effort_{};
  MovePoints points_;
  std::vector<VertexId> neighbors_;    // of the vertex
  CellList beyond_;                    // scratch of keeps_samples_covered
  CellList around_;                    // scratch of is_covered
  std::vector<Candidate> candidates_;  // improved, but still with poor cells
  Unmoved obstacle_ = Unmoved::kSpacing;
};

}  // namespace podm
