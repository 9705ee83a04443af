// Checkpoints of a run on ranks, in a folder that all ranks see. Ranks write them between rounds. Each rank
// writes the vertices in the cubes that it wrote last, so that all pieces together have each vertex once. The
// last whole checkpoint stays until a new one is whole: pieces have new names, and the text that lists them
// (checkpoint_files.h) gets its name after all pieces are on the disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "distributed/checkpoint_files.h"
#include "distributed/communication.h"
#include "files/folder_lock.h"

namespace podm {

struct CheckpointOptions {
  std::string folder;       ///< empty: no checkpoints
  double seconds = 600;     ///< the least time between two checkpoints; 0: each round ends with one
  bool is_resumed = false;  ///< the run continues from the last checkpoint in the folder
};

class Checkpoints {
 public:
  /// Collective. Makes the folder unless the run is resumed, and locks it on rank 0 while the object lives.
  /// Throws RefusedByAll if another run has locked it, or if the run is resumed and the checkpoint is absent,
  /// damaged or has other facts.
  Checkpoints(const CheckpointOptions& options, const std::vector<Fact>& facts, Communication& ranks);

  bool is_resumed() const { return last_.has_value(); }
  /// The checkpoint that is resumed, if any.
  const std::optional<CheckpointText>& resumed() const { return last_; }
  /// Collective. Returns true, on all ranks, if the time since the last checkpoint is over on any rank.
  bool is_due() const;
  /// Collective. Writes this rank's vertices after one more round. Throws RefusedByAll if any rank cannot
  /// write; the last checkpoint then stays.
  void write(const std::vector<LearntVertex>& vertices, std::uint64_t rounds_of_run);
  /// Collective. Returns this rank's share of the vertices in the checkpoint that is resumed. Every vertex is
  /// in one rank's share.
  std::vector<LearntVertex> read() const;

 private:
  using Clock = std::chrono::steady_clock;

  std::string text_path() const { return folder_ + "/checkpoint.txt"; }
  std::string piece_path(std::uint64_t number, std::uint64_t rank) const;
  void expect_text() const;
  CheckpointText read_text() const;
  std::uint64_t largest_number() const;
  void write_text(const std::vector<CheckpointPiece>& pieces, std::uint64_t rounds);
  void remove_other_pieces() const;

  const std::string folder_;
  const double seconds_;
  const std::vector<Fact> facts_;
  Communication& ranks_;
  std::optional<FolderLock> lock_;      // on rank 0
  std::optional<CheckpointText> last_;  // the checkpoint that is resumed
  std::uint64_t number_ = 0;            // of the last checkpoint in the folder, also of one that is not whole
  Clock::time_point written_ = Clock::now();
};

}  // namespace podm
