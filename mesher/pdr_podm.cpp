// PDR: Chernikov, Chrisochoides, ICS 2004; SISC 28 (2006). PDR.PODM: Feng, Tsolakis, Chernikov,
// Chrisochoides, IMR 2015, section 3.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "memory_model.h"
#include "octree/leaf_region.h"
#include "podm.h"
#include "podm/errors.h"
#include "refine/virtual_box.h"

namespace podm {

namespace {

// Leaves are this many circumradius bounds of the initial mesh long. leaf_side() proves what always suffices;
// cavities are rarely half as large, and what does not fit is deferred: on the liver 0.03 % of the operations
// at 2, 10 % at 1.4. See experiments/leaf_size.toml.
constexpr double kLeafSizeOverRadius = 2;
// Large balls outside reach over the shell to the object only if they are empty of its vertices.
constexpr double kShellOverRadius = 2;

// Circumradius bounds of the labels, mm; twice delta where only the surface drives.
struct Radii {
  std::vector<double> of_label;
  double least, most;
};

Radii radii_of(const Problem& problem) {
  Radii radii{};
  for (std::size_t label = 1; label < problem.sizes.num_labels(); ++label) {
    const double squared = problem.sizes.squared_radius(static_cast<LabelIndex>(label));
    radii.of_label.push_back(std::isinf(squared) ? 2 * problem.delta_mm : std::sqrt(squared));
  }
  const auto [least, most] = std::minmax_element(radii.of_label.begin(), radii.of_label.end());
  radii.least = *least;
  radii.most = *most;
  return radii;
}

// The largest bound of a label in the cube, by samples: leaves shorter than the coarse cells in them would
// defer most of their operations.
double radius_in_cube(const Problem& problem, const Radii& radii, const Point& low, const Point& high) {
  constexpr int kSamples = 5;
  double radius = 0;
  for (int i = 0; i < kSamples * kSamples * kSamples; ++i) {
    const auto at = [&](int k, double from, double to) { return from + (k + 0.5) / kSamples * (to - from); };
    const LabelIndex label = problem.isosurface.label_at({at(i % kSamples, low.x, high.x),
                                                          at(i / kSamples % kSamples, low.y, high.y),
                                                          at(i / kSamples / kSamples, low.z, high.z)});
    if (label != kBackground) radius = std::max(radius, radii.of_label[label - 1u]);
  }
  return radius > 0 ? radius : radii.most;
}

// Leaves near the object; the cells elsewhere are few, and left to the closing phase.
Octree make_octree(const Problem& problem, const Radii& radii, const Box& box, double ratio, double finest_mm,
                   double coarsest_mm, const std::stop_token& over) {
  const auto is_needed = [&](const Point& low, const Point& high) {
    const Point middle = low + 0.5 * (high - low);
    const double reach = 0.5 * distance(low, high) + ratio * radii.most;
    return problem.isosurface.label_at(middle) != kBackground ||
           problem.isosurface.distance_lower_bound(middle, reach) < reach;
  };
  const auto largest_side = [&](const Point& low, const Point& high) {
    if (coarsest_mm <= finest_mm) return finest_mm;
    return std::min(coarsest_mm, kLeafSizeOverRadius * ratio * radius_in_cube(problem, radii, low, high));
  };
  return Octree(box.low, box.high, finest_mm, largest_side, is_needed, over);
}

// Leaves of a size that was asked for fill the whole box: they must leave most memory to the mesh. Returns
// what they take at most.
std::uint64_t checked_bytes_of_leaves(double asked_mm, const Box& box, std::uint64_t memory_bytes) {
  constexpr double kMostLeaves = 1 << 21, kBytesPerGib = 1 << 30;
  constexpr double kMostBytesPerLeaf = kBytesPerCube + kBytesPerLeaf;
  const auto along = [&](double length_mm) { return std::max(1.0, std::ceil(length_mm / asked_mm)); };
  const Vector extent = box.high - box.low;
  const double leaves = along(extent.x) * along(extent.y) * along(extent.z);
  const double most_bytes = kMostMemoryOfLeaves * static_cast<double>(memory_bytes);
  const double most = std::min(kMostLeaves, most_bytes / kMostBytesPerLeaf);
  if (leaves <= most) return static_cast<std::uint64_t>(leaves * kMostBytesPerLeaf);
  const std::string told = fmt::format("a leaf size of {:g} mm makes {:.2g} leaves", asked_mm, leaves);
  const double enough_mm = 1.1 * asked_mm * std::cbrt(leaves / most);
  if (leaves > kMostLeaves)
    throw InputError(fmt::format("{}, the most are {}; {:.3g} mm makes fewer", told, kMostLeaves, enough_mm));
  throw InputError(fmt::format(
      "{}, which take {:.3g} GiB; of the memory limit leaves may have {:.3g} GiB; {:.3g} mm makes fewer",
      told, leaves * kMostBytesPerLeaf / kBytesPerGib, most_bytes / kBytesPerGib, enough_mm));
}

// Sides by the labels' bounds, longer where a leaf has to feed several workers, so that each has as much as
// one has of a leaf of its own: 256 simulated cores, 16 a node, were 1.46 times faster, and 16 % instead of
// 27 % of their operations rolled back. Then shorter until there are leaves enough to keep all nodes at work.
std::unique_ptr<const Octree> fit_octree(const Problem& problem, const Radii& radii, const Box& box,
                                         const LeafOptions& options, int workers_per_node,
                                         const std::stop_token& over) {
  constexpr LeafId kLeavesPerNode = 64;
  constexpr double kStep = 1.26;  // halves the number of leaves
  const double ratio = options.initial_ratio;
  if (const double asked_mm = options.leaf_size_mm; asked_mm > 0)
    return std::make_unique<Octree>(make_octree(problem, radii, box, ratio, asked_mm, asked_mm, over));
  const double finest_mm = kLeafSizeOverRadius * ratio * radii.least;
  double coarsest_mm = kLeafSizeOverRadius * ratio * radii.most;
  double growth = std::cbrt(workers_per_node);
  for (;;) {
    auto octree = std::make_unique<Octree>(
        make_octree(problem, radii, box, ratio, growth * finest_mm, growth * coarsest_mm, over));
    const LeafId wanted = kLeavesPerNode * static_cast<LeafId>(options.num_nodes);
    const bool is_finest = growth == 1 && coarsest_mm <= finest_mm;
    if (octree->num_leaves() >= wanted || is_finest || over.stop_requested()) return octree;
    if (growth > 1) {
      growth = std::max(1.0, growth / kStep);
    } else {
      coarsest_mm /= 2;
    }
  }
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
  const Radii radii = radii_of(problem);
  const double initial_radius_mm = ratio * radii.least;
  const double shell_mm = kShellOverRadius * initial_radius_mm;
  const Box clamp = grown(problem.object, std::max(2 * ratio * problem.delta_mm, shell_mm));
  const std::uint64_t bytes_of_leaves =
      options.leaf_size_mm > 0 ? checked_bytes_of_leaves(options.leaf_size_mm, clamp, problem.memory_bytes)
                               : 0;  // few

  Parameters initial = parameters_for(problem, ratio, clamp);
  initial.shell_mm = shell_mm;
  initial.shell_radius_mm = initial_radius_mm;
  const Parameters final = parameters_for(problem, 1, clamp);

  Refiner refiner(problem, clamp, crew, watch);
  refiner.withhold(bytes_of_leaves);
  refiner.refine_anywhere("initial", initial, refiner.all_cells(), options.initial_workers);
  if (refiner.is_over()) {
    refiner.timed("refine", [] {});  // every run has this phase
    return refiner.finish();
  }
  std::unique_ptr<const Octree> octree;
  refiner.timed("octree", [&] {
    octree =
        fit_octree(problem, radii, clamp, options, refiner.num_workers() / options.num_nodes, watch.over());
  });
  refiner.withhold(octree->num_cubes() * kBytesPerCube + octree->num_leaves() * kBytesPerLeaf);
  const Refiner::Entries left =
      refiner.refine_leaves<Locks>("refine", final, *octree, options.num_nodes, options.with_schedule);
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
