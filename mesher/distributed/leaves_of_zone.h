// PDR.PODM in a rank's zone: the computing nodes of its team refine leaf by leaf. (Feng, Tsolakis,
// Chernikov, Chrisochoides, IMR 2015.) What no leaf can refine is left to PODM anywhere in the zone, and what
// that cannot, to later rounds.
//
//   Nothing is locked between nodes of a rank, nor between ranks. An operation replaces only cells whose four
//   vertices are in the region of its leaf, as LeafLocks sees to, and in the zone, as ZoneLocks inside does;
//   and of those that it looks at the two that readers lock are in both. The proof for leaves
//   (octree/leaf_region.h) and that for zones (distributed/zone.h) rest on that alone: an operation that
//   either of them refuses ends with nothing written, and the other has nothing to ask of it. So each holds
//   as if the other were not, the first between the nodes of a rank, the second between ranks.
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
  /// Collective. Keeps memory for leaves of the size that was asked for, if any. Throws RefusedByAll where
  /// they take more than their share of a rank's. `algorithm` is kPdr or kPdrPodm.
  LeavesOfZone(Construction& construction, const TwoLevels& levels, const LeafOptions& options,
               Algorithm algorithm, Communication& ranks);

  struct Refined {
    Construction::Entries left;
    std::uint64_t insertions = 0;
  };
  /// Refines these cells, all of which live, in phases "octree" and "refine". The octree is that of the whole
  /// object, with leaves enough for the nodes of all ranks.
  Refined operator()(const Zone& zone, const Construction::Entries& cells);

 private:
  template <class Inner>
  Refined refine(const Zone& zone, const Construction::Entries& cells, const Octree& octree);

  Construction& construction_;
  const TwoLevels& levels_;
  const LeafOptions options_;
  const Algorithm algorithm_;
  std::uint64_t num_nodes_;  // of all ranks
};

}  // namespace podm
