// The assignment of zones to ranks in the rounds after the first.
//
// Deferred cells lie along the faces of blocks, where the zones of round 0 ended. In rounds 1 to
// kShiftedRounds the zones are the blocks with their faces shifted, farther from round to round, and, if
// blocks are long, by stripes in one direction and in the other: the two blocks share the cells of the face.
// The shifted faces lie inside blocks. The deferred cells of a face wait again only where the face meets
// another shifted face, or where the direction changes: along lines after round 1, at points after round 2,
// and hardly anywhere after rounds 3 and 4. All ranks are busy in these rounds. A zone does not include cubes
// where no cell waits and which another rank wrote last, so that they need not be sent.
//
// In later rounds zones are the connected parts of the cubes around the deferred cells. Up to round
// kLastRoundWithCuts parts with many deferred cells are cut anew, into boxes, at places where few of these
// cells would have to wait again. Parts of later rounds are not cut: they never touch, and they grow together
// until one fills space. Each zone goes to a rank whose block overlaps it, so that this part need not be
// sent.
#pragma once

#include <optional>
#include <vector>

#include "distributed/blocks.h"

namespace podm {

inline constexpr int kNoRank = -1;

inline constexpr int kShiftedRounds = 4;
inline constexpr int kLastRoundWithCuts = 8;

struct CubeCount {
  CubeId cube;
  std::uint32_t cells;
};

class Writers;

/// The zones of a round, as a function of the cube: no rank has a table of all cubes.
class Zones {
 public:
  /// The blocks, the zones of round 0.
  Zones(const CubeGrid& grid, const Blocks& blocks) : grid_(&grid), blocks_(&blocks) {}
  /// The shifted blocks of one of the rounds 1 to kShiftedRounds. A zone includes cubes of `waiting`, and
  /// those that its rank wrote last. Keeps the references.
  Zones(int round, CubeSet waiting, const Blocks& blocks, const Writers& writers);
  /// Zones of the numbered cubes alone, with the rank of each.
  Zones(CubeNumbers waiting, std::vector<int> ranks, bool are_connected)
      : grid_(&waiting.cubes().grid()),
        numbered_(std::move(waiting)),
        ranks_(std::move(ranks)),
        are_connected_(are_connected) {}

  /// Returns the rank of the cube's zone, or kNoRank.
  int rank_of(const CubePlace& at) const;
  /// Returns the cubes of the rank's zone.
  CubeSet of(int rank) const;
  /// Returns true if no two zones touch: zones must then grow from round to round.
  bool are_connected() const { return are_connected_; }
  bool are_blocks() const { return writers_ == nullptr && blocks_ != nullptr; }

 private:
  friend class Writers;
  bool is_waiting(CubeId cube) const {
    return numbered_ ? numbered_->cubes().has(cube) : waiting_ && waiting_->has(cube);
  }
  // The cube must be waiting.
  int rank_of_waiting(const CubePlace& at) const {
    return numbered_ ? ranks_[(*numbered_)[grid_->id(at)]] : shifted_block(at);
  }
  int shifted_block(const CubePlace& at) const;

  const CubeGrid* grid_;
  std::optional<CubeSet> waiting_;
  const Blocks* blocks_ = nullptr;
  const Writers* writers_ = nullptr;
  int shift_ = 0;         // cubes
  int stripe_ = 0;        // length of the stripes of one direction, in cubes; 0: there is one direction
  int first_stripe_ = 0;  // place in its stripe where the grid begins
  std::optional<CubeNumbers> numbered_;
  std::vector<int> ranks_;  // by number
  bool are_connected_ = false;
};

/// The rank that wrote each cube last, as a function of the cube.
class Writers {
 public:
  Writers(const CubeGrid& grid, const Blocks& blocks) : grid_(grid), blocks_(blocks) {}
  int of(const CubePlace& at) const;
  int of(CubeId cube) const { return of(grid_.place_of(cube)); }
  /// Notes that each rank wrote its zone.
  void note(Zones zones);

 private:
  const CubeGrid& grid_;
  const Blocks& blocks_;
  std::vector<Zones> later_;  // since each rank wrote its block
};

/// Returns the zones of a round after round 0. `waiting` are the cubes that deferred cells request, and their
/// neighbours. Rounds after the shifted ones need `num_cells`, the numbers of deferred cells in these cubes,
/// and `load`, which holds the cells that each rank had in earlier rounds. They add the cells of this round.
Zones zones_of_round(int round, const Blocks& blocks, CubeSet waiting,
                     const std::vector<CubeCount>& num_cells, const Writers& writers,
                     std::vector<std::uint64_t>& load);

}  // namespace podm
