#include "distributed/leaves_of_zone.h"

#include <array>

#include "algorithms/leaf_loop.h"
#include "algorithms/leaf_size.h"
#include "algorithms/memory_model.h"
#include "algorithms/podm_loop.h"
#include "delaunay/operation_steps.h"
#include "distributed/together.h"
#include "refine/attempt.h"

namespace podm {

LeavesOfZone::LeavesOfZone(Construction& construction, const TwoLevels& levels, const LeafOptions& options,
                           Algorithm algorithm, Communication& ranks)
    : construction_(construction), levels_(levels), options_(options), algorithm_(algorithm) {
  std::uint64_t bytes = 0;
  do_together([&] { bytes = checked_bytes_of_leaves(construction.problem(), options, levels.clamp); }, ranks);
  construction.withhold(bytes);
  std::array<std::uint64_t, 1> num_nodes{static_cast<std::uint64_t>(construction.team().num_nodes)};
  ranks.sum(num_nodes);
  num_nodes_ = num_nodes[0];
}

LeavesOfZone::Refined LeavesOfZone::operator()(const Zone& zone, const Construction::Entries& cells) {
  if (construction_.stop().is_over()) return {};
  const Problem& problem = construction_.problem();
  std::unique_ptr<const Octree> octree;
  construction_.timed("octree", [&] {
    octree = make_octree(problem, radii_of(problem), levels_.clamp, options_, num_nodes_,
                         construction_.stop().over());
  });
  construction_.withhold(octree->num_cubes() * kBytesPerCube + octree->num_leaves() * kBytesPerLeaf);
  Refined refined = algorithm_ == Algorithm::kPdr ? refine<NoLocks>(zone, cells, *octree)
                                                  : refine<VertexLocks>(zone, cells, *octree);
  octree.reset();
  construction_.withhold(0);
  return refined;
}

template <class Inner>
LeavesOfZone::Refined LeavesOfZone::refine(const Zone& zone, const Construction::Entries& cells,
                                           const Octree& octree) {
  using Locks = LeafLocks<ZoneLocks<Inner>>;
  Refined refined;
  construction_.timed("refine", [&] {
    const int num_workers = construction_.num_workers();
    const auto workers = construction_.make_workers<Locks>(levels_.final, num_workers);
    for (const auto& worker : workers) worker->locks().inner().confine(zone);
    construction_.in_time("refine", num_workers, [&](auto& time) {
      refined.left = refine_leaf_by_leaf(construction_, workers, octree, false, time, &cells);
    });
    for (const auto& worker : workers) refined.insertions += worker->counters().num_insertions();
  });
  return refined;
}

}  // namespace podm
