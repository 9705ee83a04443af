// The size of leaves, and the octree of leaves.
#pragma once

#include <memory>
#include <stop_token>

#include "algorithms/construction.h"
#include "octree/octree.h"
#include "podm/meshing_options.h"

namespace podm {

/// Returns the circumradius bound of a label at p, mm; twice delta where only the surface bounds the size.
double radius_at(const Problem& problem, LabelIndex label, const Point& p);

/// The least and the largest bound in the object, mm, by samples if a size grid contributes.
struct Radii {
  double least, most;
};
Radii radii_of(const Problem& problem);
/// Returns the least bound of the labels alone, mm.
double least_radius_of_labels(const Problem& problem);

/// Returns an upper bound of the bytes of leaves of the requested size, which are taken to fill the whole
/// box. 0: no size was requested, and leaves are few. Throws InputError if the leaves are too many or exceed
/// their share of the memory.
std::uint64_t checked_bytes_of_leaves(const Problem& problem, const LeafOptions& options, const Box& box);

/// Makes an octree of leaves near the object. The cells elsewhere are few, and left to the closing phase. The
/// sides follow from the circumradius bounds. They are longer while there are enough leaves to keep
/// `num_nodes` computing nodes at work, and shorter until there are. After a stop request the leaves are
/// unfit for use.
std::unique_ptr<const Octree> make_octree(const Problem& problem, const Radii& radii, const Box& box,
                                          const LeafOptions& options, std::uint64_t num_nodes,
                                          const std::stop_token& stop);

}  // namespace podm
