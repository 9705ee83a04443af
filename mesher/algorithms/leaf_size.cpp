#include "algorithms/leaf_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/memory_model.h"
#include "octree/leaf_region.h"
#include "podm/errors.h"

namespace podm {

namespace {

double radius_or_delta(const Problem& problem, double squared_radius) {
  return std::isinf(squared_radius) ? 2 * problem.delta_mm : std::sqrt(squared_radius);
}

Radii radii_of_labels(const Problem& problem) {
  Radii radii{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t label = 1; label < problem.sizes.num_labels(); ++label) {
    const double radius =
        radius_or_delta(problem, problem.sizes.squared_radius_of_label(static_cast<LabelIndex>(label)));
    radii = {std::min(radii.least, radius), std::max(radii.most, radius)};
  }
  return radii;
}

// Calls use(p, label) for the foreground points of a grid in the box with `num_samples` points per axis.
template <class Use>
void for_each_sample(const Problem& problem, const Point& low, const Point& high, int num_samples,
                     const Use& use) {
  const auto at = [&](int k, double from, double to) { return from + (k + 0.5) / num_samples * (to - from); };
  for (int i = 0; i < num_samples * num_samples * num_samples; ++i) {
    const Point p{at(i % num_samples, low.x, high.x), at(i / num_samples % num_samples, low.y, high.y),
                  at(i / num_samples / num_samples, low.z, high.z)};
    const LabelIndex label = problem.isosurface.label_at(p);
    if (label != kBackground) use(p, label);
  }
}

}  // namespace

double radius_at(const Problem& problem, LabelIndex label, const Point& p) {
  return radius_or_delta(problem, problem.sizes.squared_radius(label, p));
}

double least_radius_of_labels(const Problem& problem) { return radii_of_labels(problem).least; }

Radii radii_of(const Problem& problem) {
  constexpr int kSamples = 32;
  const Radii of_labels = radii_of_labels(problem);
  if (!problem.sizes.has_grid()) return of_labels;
  Radii radii{std::numeric_limits<double>::infinity(), 0};
  for_each_sample(problem, problem.object.low, problem.object.high, kSamples,
                  [&](const Point& p, LabelIndex label) {
                    const double radius = radius_at(problem, label, p);
                    radii = {std::min(radii.least, radius), std::max(radii.most, radius)};
                  });
  return radii.most > 0 ? radii : of_labels;
}

namespace {

// The side of a leaf as a multiple of the circumradius bound of the initial mesh. leaf_side() proves a side
// that always suffices. Cavities are rarely half as large, and an operation that does not fit is deferred: on
// the liver 0.03 % of the operations at 2, 10 % at 1.4. See experiments/leaf_size.toml.
constexpr double kLeafSizeOverRadius = 2;

// Returns the largest bound in the cube, by samples: leaves shorter than the coarse cells in them would defer
// most of their operations.
double radius_in_cube(const Problem& problem, const Radii& radii, const Point& low, const Point& high) {
  constexpr int kSamples = 5;
  double radius = 0;
  for_each_sample(problem, low, high, kSamples, [&](const Point& p, LabelIndex label) {
    radius = std::max(radius, radius_at(problem, label, p));
  });
  return radius > 0 ? radius : radii.most;
}

Octree octree_of_sides(const Problem& problem, const Radii& radii, const Box& box, double ratio,
                       double finest_mm, double coarsest_mm, const std::stop_token& stop) {
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
  return Octree(box.low, box.high, finest_mm, largest_side, is_needed, stop);
}

// Returns the number of cubes of this side that fill the box.
double num_cubes(const Box& box, double side_mm) {
  const auto along = [&](double length_mm) { return std::max(1.0, std::ceil(length_mm / side_mm)); };
  const Vector extent = box.high - box.low;
  return along(extent.x) * along(extent.y) * along(extent.z);
}

// Returns the longest side, up to a factor `step`, of which at least `num_wanted` cubes fill the box. A box
// that is thinner than the cubes has one cube across, and the cubes are longer than their share of its
// volume.
double side_for(const Box& box, double num_wanted, double step) {
  const Vector extent = box.high - box.low;
  double side_mm = std::cbrt(extent.x * extent.y * extent.z / num_wanted);
  while (num_cubes(box, step * side_mm) >= num_wanted) side_mm *= step;
  return side_mm;
}

}  // namespace

std::uint64_t checked_bytes_of_leaves(const Problem& problem, const LeafOptions& options, const Box& box) {
  const double asked_mm = options.size_mm;
  if (asked_mm == 0) return 0;
  constexpr double kMostLeaves = 1 << 21, kBytesPerGib = 1 << 30;
  constexpr double kMostBytesPerLeaf = kBytesPerCube + kBytesPerLeaf;
  const double leaves = num_cubes(box, asked_mm);
  const double most_bytes = kMostMemoryOfLeaves * static_cast<double>(problem.memory_bytes);
  const double most = std::min(kMostLeaves, most_bytes / kMostBytesPerLeaf);
  if (leaves <= most) return static_cast<std::uint64_t>(leaves * kMostBytesPerLeaf);
  const std::string fault = fmt::format("a leaf size of {:g} mm gives {:.2g} leaves", asked_mm, leaves);
  const double enough_mm = 1.1 * asked_mm * std::cbrt(leaves / most);
  if (leaves > kMostLeaves)
    throw InputError(fmt::format("{}, but at most {} are supported; {:.3g} mm gives fewer", fault,
                                 kMostLeaves, enough_mm));
  throw InputError(fmt::format(
      "{}, which take {:.3g} GiB; leaves may take {:.3g} GiB of the memory limit; {:.3g} mm gives fewer",
      fault, leaves * kMostBytesPerLeaf / kBytesPerGib, most_bytes / kBytesPerGib, enough_mm));
}

// Leaves are as large as possible while each node finds enough leaves beyond two rings of all active leaves.
// Remote accesses, deferred cells, cells handed over and conflicts among a leaf's workers occur along the
// leaf's sides. Where the initial mesh is too coarse for enough leaves, they are as short as it allows.
std::unique_ptr<const Octree> make_octree(const Problem& problem, const Radii& radii, const Box& box,
                                          const LeafOptions& options, std::uint64_t num_nodes,
                                          const std::stop_token& stop) {
  constexpr std::uint64_t kLeavesPerNode = 64;
  constexpr double kStep = 1.26;  // halves the number of leaves
  const double ratio = options.initial_ratio;
  if (const double asked_mm = options.size_mm; asked_mm > 0)
    return std::make_unique<Octree>(octree_of_sides(problem, radii, box, ratio, asked_mm, asked_mm, stop));
  const double finest_mm = kLeafSizeOverRadius * ratio * radii.least;
  double coarsest_mm = kLeafSizeOverRadius * ratio * radii.most;
  const std::uint64_t wanted = kLeavesPerNode * num_nodes;
  double growth = std::max(1.0, side_for(box, static_cast<double>(wanted), kStep) / finest_mm);
  for (;;) {
    auto octree = std::make_unique<Octree>(
        octree_of_sides(problem, radii, box, ratio, growth * finest_mm, growth * coarsest_mm, stop));
    const bool is_finest = growth == 1 && coarsest_mm <= finest_mm;
    if (octree->num_leaves() >= wanted || is_finest || stop.stop_requested()) return octree;
    if (growth > 1) {
      growth = std::max(1.0, growth / kStep);
    } else {
      coarsest_mm /= 2;
    }
  }
}

}  // namespace podm
