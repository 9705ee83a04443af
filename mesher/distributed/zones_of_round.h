// The assignment of zones to ranks in the rounds after the first.
//
// Deferred cells lie along the cuts of earlier rounds, where the zones of these rounds ended. Each round
// therefore cuts space anew, into boxes with at least half of an even share of the deferred cells, at places
// where few of these cells would have to wait again. Cuts reduce a plate of deferred cells to a strip, and a
// strip to a spot. In late rounds, or if few cells wait, zones are the connected parts of the cubes around
// the deferred cells. These zones never touch, and they grow together until one fills space. Each zone goes
// to a rank whose block overlaps it, so that this part need not be sent.
#pragma once

#include <vector>

#include "distributed/blocks.h"

namespace podm {

inline constexpr int kNoRank = -1;

/// Returns true if a round cuts the deferred cells. Other rounds have connected zones, which must grow each
/// time for the rounds to end.
bool has_cuts(int round, std::uint64_t num_waiting);

/// Returns the rank of every cube's zone, or kNoRank. `waiting` are the cubes that deferred cells request,
/// and their neighbours; `num_cells` is the number of deferred cells by cube. `load` holds the cells that
/// each rank had in earlier rounds; the cells of this round are added.
std::vector<int> zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting,
                                const std::vector<std::uint32_t>& num_cells,
                                std::vector<std::uint64_t>& load);

}  // namespace podm
