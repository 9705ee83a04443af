// PDR: Chernikov, Chrisochoides, ICS 2004; SISC 28 (2006). PDR.PODM: Feng, Tsolakis, Chernikov,
// Chrisochoides, IMR 2015, section 3.
#include <algorithm>
#include <cmath>
#include <memory>

#include "octree/leaf_region.h"
#include "podm.h"
#include "refine/virtual_box.h"

namespace podm {

namespace {

// Leaves are this many circumradius bounds of the initial mesh long. leaf_side() proves what always suffices;
// cavities are rarely half as large, and what does not fit is deferred: see experiments/leaf_size.toml.
constexpr double kLeafSizeOverRadius = 2;
// Large balls outside reach over the shell to the object only if they are empty of its vertices.
constexpr double kShellOverRadius = 2;

// Cubes near the object; the cells of others are few, and left to the closing phase.
Octree make_octree(const Problem& problem, const Box& box, double side_mm, double reach_mm) {
  const auto is_needed = [&](const Point& low, const Point& high) {
    const Point middle = low + 0.5 * (high - low);
    const double radius = 0.5 * distance(low, high) + reach_mm;
    return problem.isosurface.label_at(middle) != kBackground ||
           problem.isosurface.distance_lower_bound(middle, radius) < radius;
  };
  return Octree(
      box.low, box.high, side_mm, [&](const Point&, const Point&) { return side_mm; }, is_needed);
}

void describe(const Octree& octree, LeafSchedule& schedule) {
  const Point& origin = octree.origin();
  schedule.origin_mm = {origin.x, origin.y, origin.z};
  schedule.side_mm = octree.finest_side_mm();
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf)
    schedule.leaves.push_back({octree.cube(leaf).corner, octree.cube(leaf).side});
}

// The initial mesh, the leaves, and what they leave.
template <class Locks>
Refinement refine_by_leaves(const Problem& problem, const Crew& crew, const LeafOptions& options,
                            Watch& watch) {
  const double ratio = options.initial_ratio;
  const double finest_mm = std::sqrt(problem.sizes.smallest_squared_radius());
  const double initial_radius_mm = ratio * (std::isinf(finest_mm) ? 2 * problem.delta_mm : finest_mm);
  const double shell_mm = kShellOverRadius * initial_radius_mm;
  const Box clamp = grown(problem.object, std::max(2 * ratio * problem.delta_mm, shell_mm));

  Parameters initial = parameters_for(problem, ratio, clamp);
  initial.shell_mm = shell_mm;
  initial.shell_radius_mm = initial_radius_mm;
  const Parameters final = parameters_for(problem, 1, clamp);

  Refiner refiner(problem, clamp, crew, watch);
  refiner.refine_anywhere("initial", initial, refiner.all_cells(), options.initial_workers);
  std::unique_ptr<const Octree> octree;
  refiner.timed("octree", [&] {
    const double side_mm =
        options.leaf_size_mm > 0 ? options.leaf_size_mm : kLeafSizeOverRadius * initial_radius_mm;
    octree = std::make_unique<Octree>(make_octree(problem, clamp, side_mm, initial_radius_mm));
  });
  Refiner::Entries left;
  refiner.timed("refine", [&] {
    left = refiner.refine_leaves<Locks>(final, *octree, options.num_nodes, options.with_schedule);
  });
  refiner.refine_anywhere("closing", final, left, refiner.num_workers());
  Refinement result = refiner.finish();
  if (result.schedule) describe(*octree, *result.schedule);
  return result;
}

}  // namespace

Refinement pdr(const Problem& problem, const Crew& crew, const LeafOptions& options, Watch& watch) {
  return refine_by_leaves<LeafLocks<NoLocks>>(problem, crew, options, watch);
}

Refinement pdr_podm(const Problem& problem, const Crew& crew, const LeafOptions& options, Watch& watch) {
  return refine_by_leaves<LeafLocks<VertexLocks>>(problem, crew, options, watch);
}

}  // namespace podm
