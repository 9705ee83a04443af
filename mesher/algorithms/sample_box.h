// Samples of a flat box, before any rule asks.
#pragma once

#include "algorithms/construction.h"

namespace podm {

/// Inserts samples of the isosurface at the corners of the problem's flat box, along its edges, and along the
/// curves in which interfaces meet its sides. Neighbors are 0.7 to 1.4 delta apart, and no sample is nearer
/// than 0.7 delta to another, or in the ball of an edge of a line. R1 then keeps delta from them, so that few
/// facets on the sides cross these edges and curves, and R3 has few to add. Does nothing if the box is open.
/// Lines must be sampled before. Ends early when the run is over. Charges `phase`.
void sample_box(Construction& construction, const Parameters& parameters, const char* phase);

}  // namespace podm
