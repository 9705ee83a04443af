// The part of the structure claim that needs geometry beyond single cells: no overlap, no hanging vertex.
#pragma once

#include "claims/tally.h"
#include "geometry/adjacency.h"
#include "options.h"

namespace podm::verify {

/// Needs cells that are not flat. `is_left_handed`: positive cells are those of negative orientation.
///
/// Only boundary facets need a look. Let the covering number of a point be the number of cells that hold it
/// inside. Where each interior facet has its two cells on opposite sides, the number changes across boundary
/// facets only. If it is two or more somewhere, it falls below two on the way out, across some boundary facet
/// whose own cell is on the inner side; just inside of that facet another cell is present as well. So the
/// mesh overlaps itself exactly when just inside of some boundary facet T there is a cell C other than T's
/// own.
///
/// That is so when no facet of the polytope D = C - T (Minkowski) but the one whose inner normal is T's own
/// inner normal n keeps the origin from the inside of D, and that one does not keep it from D: then the
/// inside of C either meets the inside of T, or C lies on the inner side and touches T in inner points. The
/// facets of D are those of C, translates of T (normals n and -n), and sums of an edge of T and one of C: so
/// planes through facets of C, through T, and through an edge of T parallel to an edge of C decide it,
/// exactly, by signs of determinants.
Tally check_overlap(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed, int threads);

/// A used vertex that lies on a boundary facet or its edges without being a vertex of it. (On an interior
/// facet it would make cells overlap.)
Tally check_hanging_vertices(const Mesh& mesh, const Adjacency& adjacency, int threads);

}  // namespace podm::verify
