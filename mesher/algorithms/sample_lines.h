// Lines as edges of the mesh: they are sampled before refinement, and mended after it.
#pragma once

#include "algorithms/construction.h"

namespace podm {

/// Inserts the nodes of the problem's lines, and vertices along their arcs at most the lines' delta apart.
/// Splits edges until each is in the mesh, has no vertex in its ball, and leaves its arc by at most a quarter
/// of the lines' delta; edges at the floor stay as they are. Lines whose ends are too near to others are left
/// out. From then on all workers with these parameters keep the edges. Does nothing if the problem has no
/// lines. Ends early when the run is over: the arcs that are sampled then keep their edges. Throws InputError
/// if the lines' delta is below a quarter of the spacing of vertices. Charges the phase "lines".
void sample_lines(Construction& construction, Parameters& parameters);

/// Splits the edges that are not in the mesh, or leave their arcs, and refines what this made, again and
/// again until no edge can be split. Vertices that have lost all their edges then count as other vertices of
/// the isosurface. `parameters` are those of the refinement, which has ended. Charges the phase "lines".
void mend_lines(Construction& construction, const Parameters& parameters);

}  // namespace podm
