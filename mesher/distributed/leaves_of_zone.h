// PDR.PODM in a rank's zone: the computing nodes of the rank's team refine leaf by leaf. (Feng, Tsolakis,
// Chernikov, Chrisochoides, IMR 2015.) PODM then refines anywhere in the zone what no leaf can refine. Cells
// that PODM cannot refine wait for later rounds.
//
//   Neither nodes of a rank nor ranks lock against each other. An operation replaces only cells whose four
//   vertices are in the region of its leaf (LeafLocks ensures this) and in the zone (the inner ZoneLocks
//   ensures this). The two vertices that readers lock of a cell that it reads are in both. The proof for
//   leaves (octree/leaf_region.h) and the proof for zones (distributed/zone.h) use only these facts: an
//   operation that one of the two refuses ends with nothing written and requires nothing of the other.
//   Each proof therefore holds independently, the first between the nodes of a rank, the second between
//   ranks.
#pragma once

#include "algorithms/construction.h"
#include "algorithms/podm.h"
#include "distributed/communication.h"
#include "distributed/zone.h"
#include "octree/octree.h"
#include "podm/meshing_options.h"

namespace podm {

class LeavesOfZone {
 public:
  /// Collective. Reserves memory for leaves of the requested size, if any. Throws RefusedByAll if they take
  /// more than their share of a rank's memory. `algorithm` is kPdr or kPdrPodm.
  LeavesOfZone(Construction& construction, const TwoLevels& levels, const LeafOptions& options,
               Algorithm algorithm, Communication& ranks);

  struct Refined {
    Construction::Entries left;
    std::uint64_t insertions = 0;
  };
  /// Refines these cells, all of which must be alive, in phases "octree" and "refine". The octree is that of
  /// the whole object, with enough leaves for the nodes of all ranks.
  Refined operator()(const Zone& zone, const Construction::Entries& cells);

 private:
  template <class Inner>
  Refined refine(const Zone& zone, const Construction::Entries& cells, const Octree& octree);

  Construction& construction_;
  const TwoLevels& levels_;
  const LeafOptions options_;
  const Algorithm algorithm_;
  std::uint64_t num_nodes_;  // on all ranks
};

}  // namespace podm
