// How large leaves are, and which there are.
#pragma once

#include <memory>
#include <stop_token>

#include "algorithms/construction.h"
#include "octree/octree.h"
#include "podm/meshing_options.h"

namespace podm {

/// The circumradius bound of a label at p, mm; twice delta where only the surface drives.
double radius_at(const Problem& problem, LabelIndex label, const Point& p);

/// The least and the largest of them in the object, by samples where they are not those of the labels alone.
struct Radii {
  double least, most;
};
Radii radii_of(const Problem& problem);
/// The least of the labels alone, mm.
double least_radius_of_labels(const Problem& problem);

/// What leaves of the size that was asked for take at most, bytes. 0: no size was asked for, and they are
/// few. Throws InputError where they take more than their share of the memory: leaves of such a size fill the
/// whole box.
std::uint64_t checked_bytes_of_leaves(const Problem& problem, const LeafOptions& options, const Box& box);

/// Leaves near the object; the cells elsewhere are few, and left to the closing phase. Their sides follow
/// from the labels' bounds, longer where a leaf has to feed several workers, then shorter until there are
/// leaves enough to keep so many computing nodes at work. A stop request leaves them unfit.
std::unique_ptr<const Octree> make_octree(const Problem& problem, const Radii& radii, const Box& box,
                                          const LeafOptions& options, std::uint64_t num_nodes,
                                          const std::stop_token& stop);

}  // namespace podm
