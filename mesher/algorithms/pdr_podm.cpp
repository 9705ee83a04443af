// PDR.PODM as a run: the initial mesh, the octree, the leaves, and the closing phase. Numbers in comments are
// lines of Fig. 3. The loop over leaves is in leaf_loop.h.
#include "algorithms/leaf_loop.h"
#include "algorithms/leaf_size.h"
#include "algorithms/memory_model.h"
#include "algorithms/mend_topology.h"
#include "algorithms/perturb_mesh.h"
#include "algorithms/podm.h"
#include "algorithms/sample_box.h"
#include "algorithms/sample_lines.h"

namespace podm {

namespace {

template <class Locks>
Construction::Entries refine_leaves(Construction& construction, const Parameters& parameters,
                                    const Octree& octree, const LeafOptions& options) {
  Construction::Entries left;
  construction.timed("refine", [&] {
    construction.in_time("refine", construction.num_workers(), [&](auto& time) {
      const auto workers = construction.make_workers<Locks>(parameters, construction.num_workers());
      left = refine_leaf_by_leaf(construction, workers, octree, options.with_schedule, time);
    });
  });
  construction.sample_pages("refine");
  return left;
}

// Every run has a phase of refinement. No octree is made without need: the one requested may be impossible.
Refinement ended_early(Construction& construction) {
  construction.timed("refine", [] {});
  return construction.finish();
}

template <class Locks>
Refinement refine_by_leaves(const Problem& problem, const Team& team, const LeafOptions& options,
                            StopControl& stop) {
  const Radii radii = radii_of(problem);
  TwoLevels levels = two_levels(problem, options.initial_ratio);
  const std::uint64_t bytes_of_leaves = checked_bytes_of_leaves(problem, options, levels.clamp);

  Construction construction(problem, levels.clamp, team, stop);  // 1
  construction.reduce_capacity(bytes_of_leaves);
  sample_lines(construction, levels.final);
  sample_box(construction, levels.final, "initial");
  levels.initial.lines = levels.final.lines;
  refine_anywhere(construction, "initial", levels.initial, construction.all_cells(),
                  team.initial_workers);  // 4
  if (stop.is_over()) return ended_early(construction);
  std::unique_ptr<const Octree> octree;
  construction.timed("octree", [&] {  // 2, 3: after 4, which makes no difference to leaves
    octree = make_octree(problem, radii, levels.clamp, options, static_cast<std::uint64_t>(team.num_nodes),
                         stop.over());
    return making_cubes(octree->num_cubes());
  });
  construction.reduce_capacity(octree->num_cubes() * kBytesPerCube + octree->num_leaves() * kBytesPerLeaf);
  const auto left = refine_leaves<Locks>(construction, levels.final, *octree, options);  // 5 to 29
  refine_anywhere(construction, "closing", levels.final, left, construction.num_workers());
  mend_topology(construction, levels.final);
  mend_lines(construction, levels.final);
  perturb_mesh(construction, levels.final);
  return construction.finish();  // 30
}

}  // namespace

Refinement pdr(const Problem& problem, const Team& team, const LeafOptions& options, StopControl& stop) {
  return refine_by_leaves<LeafLocks<NoLocks>>(problem, team, options, stop);
}

Refinement pdr_podm(const Problem& problem, const Team& team, const LeafOptions& options, StopControl& stop) {
  return refine_by_leaves<LeafLocks<VertexLocks>>(problem, team, options, stop);
}

}  // namespace podm
