// Which rank refines where in the rounds after the first.
//
// What waits lies along the cuts of earlier rounds, whose zones ended there. So each round cuts space anew,
// into boxes with at least half of an even share of it, where little of it would have to wait again: what
// cuts leave of a plate is a strip, and of a strip a spot. In the end, or when little waits, zones are the
// connected parts of the cubes around what waits: these never touch, and grow together until one fills space.
// Each zone goes to a rank whose block is in it, so that part of it need not travel.
#pragma once

#include <vector>

#include "distributed/blocks.h"

namespace podm {

inline constexpr int kNobody = -1;

/// Whether a round cuts what waits. Others have connected zones, which must grow each time for rounds to end.
bool has_cuts(int round, std::uint64_t num_waiting);

/// The rank of every cube's zone, or kNobody. `waiting` are the cubes that deferred cells ask for, and those
/// around; `num_cells`, by cube, how many there are. `load`: the cells that each rank had in earlier rounds;
/// this one's are added.
std::vector<int> zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting,
                                const std::vector<std::uint32_t>& num_cells,
                                std::vector<std::uint64_t>& load);

}  // namespace podm
