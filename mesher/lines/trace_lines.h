// Traces the lines of an image: the curves where three or more labels of the label function meet, and those
// of a flat box.
//
// The label function is that of the isosurface (isosurface.h). With a flat box it is that of the image inside
// the outer faces of the outermost voxels, as if these voxels went on, and background outside.
//
// How close the network is to the exact curves, with lengths in voxels along each axis:
// - Points of arcs lie on a curve, except within kShortArc of a node, where a node stands for several, and
//   within kMergeDistance where one arc stands for several (lines/line_graph.h, lines/chains.h). Chords
//   between them leave the curve by about kSimplifyTolerance.
// - Every point where three labels meet is within kFoundDistance of an arc, or in an undecided place. The
//   test is exact: it rules labels out in boxes of down to 1/64 voxel (lines/lattice.h).
//
// The result is the same for any number of threads: blocks are traced independently of each other, and joined
// in their order.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "isosurface/voxel_weights.h"
#include "lines/line_network.h"
#include "podm/label_image.h"

namespace podm {

/// Places where three labels meet are found if an arc is this near, in voxels.
inline constexpr double kFoundDistance = 0.5;

struct LineOptions {
  bool has_lines = false;         ///< trace the curves of three labels and more
  bool is_box_flat = false;       ///< trace the box, to which the object is cut
  std::vector<bool> counts = {};  ///< by label: curves need three that count; empty if all count
  int threads = 0;                ///< 0: all cores
  /// Any thread asks at each few rows of blocks. Once it is true, tracing ends.
  std::function<bool()> is_over = nullptr;
  std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max();
};

/// An upper estimate of the memory that trace_lines() takes, the network included.
std::uint64_t memory_of_lines(const LabelImage& image, const LineOptions& options);

/// Traces the lines of an image that holds its voxels. `weights` is null unless interfaces are smoothed.
/// Throws InputError if the estimated memory exceeds the limit, or if a sheared image is to have a flat box.
/// The network is empty, and not whole, if tracing ended early.
LineNetwork trace_lines(const LabelImage& image, const VoxelWeights* weights, const LineOptions& options);

}  // namespace podm
