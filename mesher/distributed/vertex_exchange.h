// Exchange of vertices between ranks. Cells need not be sent: a Delaunay triangulation whose ties are broken
// by coordinates is a function of its vertices. The rank that last wrote a cube sends all vertices of the
// cube. The requesting rank removes and inserts the vertices that differ from its own. No rank therefore has
// to remember what it sent earlier to which rank.
#pragma once

#include "distributed/communication.h"
#include "distributed/cubes.h"
#include "distributed/learner.h"
#include "distributed/vertex_source.h"
#include "distributed/zones_of_round.h"

namespace podm {

class VertexExchange : public VertexSource {
 public:
  /// Keeps the references. Each rank has written its block and has all vertices of `known`.
  VertexExchange(Communication& ranks, Learner& learner, const CubeGrid& grid, const Blocks& blocks,
                 CubeSet known)
      : ranks_(ranks), learner_(learner), grid_(grid), writers_(grid, blocks), known_(std::move(known)) {}

  /// Notes that from now on each rank has the current vertices of its zone, this one of `own`.
  void note_writers(Zones zones, const CubeSet& own);

  /// Returns the rank that wrote each cube last.
  const Writers& writers() const { return writers_; }
  /// Returns the cubes that this rank wrote last.
  CubeSet written() const;
  CubeSet known() const override { return known_; }
  /// Compares the cubes that this rank knows with those of their writers (overlap.h). Collective.
  void check() const;
  /// Collective.
  Update update(const CubeSet& wanted, std::vector<CellId>* made = nullptr) override;

 private:
  struct SentVertex {
    Point point;
    VertexKind kind;
  };

  std::vector<Bytes> answers_to(const std::vector<Bytes>& asked) const;
  std::vector<LearntVertex> missing(const std::vector<LearntVertex>& all,
                                    const std::vector<LearntVertex>& others) const;
  std::vector<LearntVertex> differences(const std::vector<Bytes>& received, Update& update) const;

  Communication& ranks_;
  Learner& learner_;
  const CubeGrid& grid_;
  Writers writers_;
  CubeSet known_;  // cubes of which this rank's copy is current
};

}  // namespace podm
