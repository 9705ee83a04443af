// The histories of vertices in the logs of ranks: who inserted, removed, learnt and forgot a vertex, in which
// step. replay_on_ranks.h says what they prove.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "distributed/cubes.h"
#include "podm/operation_log.h"

namespace podm {

/// An entry of a log about the vertex at a point.
struct VertexEvent {
  enum class What : std::uint32_t { kSeeded, kInserted, kRemoved, kLearnt, kForgotten };
  Point point;
  std::uint64_t sequence;  ///< of the entry in the rank's log
  What what;
  std::uint32_t kind;  ///< the VertexKind; 0 if the vertex is gone
};

/// Returns the events of a rank's log, in its order. The log must be one that replay() accepts.
std::vector<VertexEvent> events_of(const OperationLog& log);

/// The histories of the vertices with points in one rank's block.
class VertexHistories {
 public:
  explicit VertexHistories(CubeSet block) : block_(std::move(block)) {}
  /// Adds events of a rank in the block. `known`: the cubes whose vertices the rank has at the end, all or
  /// those in the block.
  void add(int rank, const std::vector<VertexEvent>& events, const std::vector<CubesOfRank::Run>& known);
  /// Throws InputError that names point, step and ranks if two logs contradict each other, or if a rank lacks
  /// a vertex of a cube that it knows, or has one too many.
  void check();

 private:
  struct OfRank {
    VertexEvent event;
    int rank;
  };
  // The history of one vertex up to a step.
  struct Vertex {
    bool exists = false;
    std::uint32_t kind = 0;
    std::map<int, bool> is_on_rank{};
  };

  using Events = std::vector<OfRank>::const_iterator;
  static void follow(Events begin, Events end, Vertex& vertex);
  void check_end(const Point& p, const Vertex& vertex) const;

  CubeSet block_;
  std::vector<OfRank> events_;
  std::map<CubeId, std::vector<int>> ranks_that_know_;  // by cube of the block
};

}  // namespace podm
