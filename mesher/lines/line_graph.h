// The graph of all traced curves, in index coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point.h"
#include "lines/pieces.h"
#include "podm/label_image.h"

namespace podm {

/// An arc shorter than this, in voxels, is contracted to a node.
inline constexpr double kShortArc = 0.25;
/// A closed arc shorter than this, in voxels, is removed.
inline constexpr double kShortLoop = 0.5;

struct GraphNode {
  Point point;
  std::uint8_t sides = 0;
  std::vector<LabelIndex> labels;  // sorted
};

struct GraphArc {
  std::array<std::int32_t, 2> ends{-1, -1};  // nodes; -1: the arc is closed
  std::uint8_t sides = 0;
  std::vector<LabelIndex> labels;  // sorted
  std::vector<Point> points;       // the nodes' points included; closed: first == last

  bool is_closed() const { return ends[0] < 0; }
};

struct LineGraph {
  std::vector<GraphNode> nodes;
  std::vector<GraphArc> arcs;
};

/// Joins pieces at their joints. Where exactly two pieces meet, with the same labels and sides, an arc goes
/// on. All other joints become nodes. `parts` is empty afterwards.
LineGraph join_pieces(std::vector<Pieces>& parts, std::size_t threads);

/// Removes what is too short or too close to be distinguished, until nothing changes:
/// - The nodes of an arc below kShortArc become one node, from the shortest arc on, as long as the box of all
///   nodes that become one has sides of at most twice that. The node is the mean of them. A node on sides of
///   the box stays there: it absorbs only nodes on no other sides.
/// - Arcs between the same two nodes that stay within kMergeDistance of each other become one, with all their
///   labels. Pairs of them with the same labels are removed.
/// - An arc from a node to itself is removed if it stays within kShortArc of it.
/// - A node of two arcs with its sides and the same labels vanishes.
/// Closed arcs below kShortLoop are removed at the end. Returns a point of each removed pair and closed arc
/// of lines, and the length of all their arcs that were contracted or removed, where no arc of their labels
/// is left. With `leaves_sides`, arcs whose ends move along a side of the box still leave the side there.
RemovedCurves simplify(LineGraph& graph, bool leaves_sides);

}  // namespace podm
