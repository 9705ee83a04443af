// The part of the structure claim that needs geometry beyond single cells: no overlap, no hanging vertex.
#pragma once

#include "claims/tally.h"
#include "geometry/adjacency.h"
#include "options.h"

namespace podm::verify {

/// Needs cells that are not flat. `is_left_handed`: positive cells are those of negative orientation.
///
/// Overlap. Let the covering number of a point be the number of cells that hold it inside. Where each
/// interior facet has its two cells on opposite sides, the number changes across boundary facets only. If it
/// is two or more somewhere, it falls below two on the way out, across some boundary facet whose own cell is
/// on the inner side; just inside of that facet another cell is present as well. So the mesh overlaps itself
/// exactly when just inside of some boundary facet there is a cell other than the facet's own.
///
/// That is decided by separating planes. Two convex bodies have no inner point in common exactly when a plane
/// through a facet of one, or along an edge of each, separates them; here the one is the boundary facet, made
/// a prism by an infinitesimal step inside. Exact, by signs of determinants.
Tally check_overlap(const Mesh& mesh, const Adjacency& adjacency, bool is_left_handed, int threads);

/// A vertex that lies on a boundary facet or its edges without being a vertex of it. (On an interior facet it
/// would make cells overlap.)
Tally check_hanging_vertices(const Mesh& mesh, const Adjacency& adjacency, int threads);

}  // namespace podm::verify
