// The part of the structure claim that needs geometry beyond single cells: no overlap, no hanging vertex.
#pragma once

#include "claims/tally.h"
#include "geometry/adjacency.h"
#include "options.h"

namespace podm::verify {

/// No cell may be flat. If `is_left_handed`, positive cells are those of negative orientation.
///
/// Only boundary facets need to be checked. Let the covering number of a point be the number of cells that
/// contain it in their inside. If each interior facet has its two cells on opposite sides, the number changes
/// across boundary facets only. If it is two or more somewhere, it falls below two on the way out, across
/// some boundary facet whose own cell is on the inner side. Just inside of that facet another cell is present
/// as well. The mesh therefore overlaps itself exactly if just inside of some boundary facet T there is a
/// cell C other than T's own.
///
/// This holds when the polytope D = C - T (Minkowski) meets two conditions. No facet of D, except the one
/// whose inner normal is T's own inner normal n, keeps the origin from the inside of D. That facet does not
/// keep the origin from D. Then the inside of C either meets the inside of T, or C lies on the inner side and
/// touches T in inner points. The facets of D are those of C, translates of T (normals n and -n), and sums of
/// an edge of T and an edge of C. Planes through facets of C, through T, and through an edge of T parallel to
/// an edge of C therefore decide it, exactly, by signs of determinants.
Tally check_overlap(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed, int threads);

/// Finds used vertices that lie on a boundary facet or its edges without being a vertex of it. (On an
/// interior facet such a vertex would make cells overlap.)
Tally check_hanging_vertices(const Mesh& mesh, const Adjacency& adjacency, int threads);

}  // namespace podm::verify
