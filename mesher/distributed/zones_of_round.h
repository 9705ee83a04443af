// The assignment of zones to ranks in the rounds after the first.
//
// Deferred cells lie along the faces of blocks, where the zones of round 0 ended. In rounds 1 to
// kShiftedRounds the zones are the blocks, shifted each time by the same number of cubes along each axis. The
// faces of a shifted block lie inside blocks. The deferred cells of a face wait again only where the face
// meets a shifted face: along lines after round 1, at points after round 2, and hardly anywhere after round
// 3. All ranks are busy in these rounds. A zone does not include cubes where no cell waits and which another
// rank wrote last, so that they need not be sent.
//
// In later rounds zones are the connected parts of the cubes around the deferred cells. Up to round
// kLastRoundWithCuts parts with many deferred cells are cut anew, into boxes, at places where few of these
// cells would have to wait again. Parts of later rounds are not cut: they never touch, and they grow together
// until one fills space. Each zone goes to a rank whose block overlaps it, so that this part need not be
// sent.
#pragma once

#include <vector>

#include "distributed/blocks.h"

namespace podm {

inline constexpr int kNoRank = -1;

inline constexpr int kShiftedRounds = 3;
inline constexpr int kLastRoundWithCuts = 8;

struct Zones {
  std::vector<int> rank_of_cube;  ///< by cube: the rank of its zone, or kNoRank
  bool are_connected = false;     ///< no two zones touch: zones must grow from round to round
};

/// Returns the zones of a round after round 0. `waiting` are the cubes that deferred cells request, and their
/// neighbours; `num_cells` is the number of deferred cells by cube, and `writer_of_cube` the rank that wrote
/// each cube last. `load` holds the cells that each rank had in earlier rounds; the cells of this round are
/// added.
Zones zones_of_round(int round, const Blocks& blocks, const CubeSet& waiting,
                     const std::vector<std::uint32_t>& num_cells, const std::vector<int>& writer_of_cube,
                     std::vector<std::uint64_t>& load);

}  // namespace podm
