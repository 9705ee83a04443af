// Rule R7: a cell inside with a dihedral angle out of bounds is poor, and one of its vertices moves, if that
// makes the angles around it better and breaks nothing. It comes last, on a mesh that breaks no other rule.
//
// (CGAL's perturbation moves vertices of slivers, too: Tournois, Srinivasan, Alliez, "Perturbing slivers in
// 3D Delaunay meshes", IMR 2009. It gives up ratio and facet angles.)
//
// A move is one operation: the vertex is removed, and inserted elsewhere; the cells are then the Delaunay
// triangulation again. It is planned (delaunay/vertex_move.h), and carried out if of the planned cells
//   (i)   those inside all have a quality (geometry/dihedral.h) of 1, or of kQualityStep more than the least
//         among the cells that they replace,
//   (ii)  none asks for anything by R1 to R5, nor does any other cell, and
//   (iii) the vertex keeps what I1 to I3 (rules.h) ask for with s in m's place from all others.
// What stays asks for nothing by R2 to R5: they ask about a cell and its neighbours, and a facet's dual edge
// changes only with one of its cells. R1 asks for isosurface vertices: where a free one moves, they stay. One
// of these moves near its tangent plane and back onto the isosurface, and may uncover samples of cells that
// stay, within delta of where it was; their balls have the samples, so they are among the cells whose balls
// reach into that ball of radius delta. Of these, cells that a vertex of their own covers keep it; the
// others, as whoever examined them has told (Mesh::relies_on_others), are asked again. So all guarantees of
// R1 to R6 hold after each move as they did before it.
//
// It ends. Let n_i be the number of poor cells inside with a quality from i to i + 1 times kQualityStep. If i
// is the least class of what a move replaces, it makes no cell of class i or less, and n_i falls: so (n_0,
// n_1, ...) falls in lexicographic order, and of such finite tuples of natural numbers there is no infinite
// falling sequence. In between each poor cell is tried once in each of a few rounds.
//
// Workers do this at the same time as they do R1 to R6, and for the same reasons (delaunay/vertex_locks.h).
// All vertices of what a move replaces are locked before anything is written, and so are two of each cell
// that is asked, or looked at beyond it: it stays as it is until the move is over, and whoever changes it
// later sees the move. What is asked about a planned cell, or one that stays, depends on vertices of such
// cells and of their neighbours alone. Could two moves each rely on a vertex that the other takes away? The
// one relies on it as a vertex of a cell which it has locked two vertices of, or beside such; the other
// replaces all cells around the vertex, so all their vertices are its own. Hence in any run moves are those
// of some serial run, where each is as above, and they end.
#pragma once

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "delaunay/cell_list.h"
#include "delaunay/operation.h"
#include "geometry/dihedral.h"
#include "podm/bounds.h"
#include "podm/perturbed.h"
#include "refine/cell_quality.h"
#include "refine/move_judge.h"
#include "refine/move_points.h"
#include "refine/rules.h"

namespace podm {

/// Of DihedralBounds::quality, which is squared.
inline constexpr double kQualityStep = 0.05;

template <class Locks>
class Perturbation {
 public:
  /// All references are kept. `seed` draws the points that are tried.
  Perturbation(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters, const Rules& rules,
               Operation<Locks>& operation, const DihedralBounds& bounds, std::uint64_t seed,
               const std::optional<CountedReads>& reads)
      : mesh_(mesh),
        rules_(rules),
        operation_(operation),
        bounds_(bounds),
        judge_(operation.move(), isosurface, parameters, bounds_, operation.counters(), reads),
        random_(seed) {}

  /// Whether the cell is inside and has an angle out of bounds.
  bool is_poor(CellId c) const {
    return cell_quality(mesh_, c, bounds_) < 1 && rules_.label_of(c) != kBackground;
  }
  bool has_free_vertex(CellId c) const {
    const auto& vertices = mesh_.cell(c).vertices;
    return std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) { return is_free(v); });
  }
  /// Of the cells to come.
  void set_effort(const MoveEffort& effort) { effort_ = effort; }
  /// Plans a move that makes a poor cell better. kDone: the operation is to insert move().point() and commit.
  /// kNoMove: none is accepted, as why_not() tells. Unless done the caller must roll back.
  StepResult plan(CellId poor);
  Unmoved why_not() const { return why_not_; }

 private:
  struct Candidate {
    Point point;
    double quality;
  };

  bool is_free(VertexId v) const { return mesh_.vertex(v).kind == VertexKind::kCircumcenter; }
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
  std::vector<Candidate> candidates_;  // better, but not good
  Unmoved why_not_ = Unmoved::kSpacing;
};

}  // namespace podm
