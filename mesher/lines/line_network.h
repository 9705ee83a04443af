// The curves that a mesh keeps as edges: a network of arcs that meet at nodes. Points are in mm, in the
// working frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/point.h"
#include "image/voxel.h"
#include "podm/label_image.h"

namespace podm {

/// A line is a curve along which at least this many labels meet. Curves of two are on sides of the box.
inline constexpr std::size_t kLabelsOfLine = 3;

/// A point where arcs end or meet, or a corner of the box.
struct LineNode {
  Point point;
  std::uint8_t sides = 0;          ///< bit k: the node lies on side k of the box: i-, i+, j-, j+, k-, k+
  std::vector<LabelIndex> labels;  ///< sorted, all that meet here
};

/// A curve between two nodes, or a closed one.
struct LineArc {
  std::vector<Point> points;     ///< a polyline, from the first node's point to the last one's
  std::int32_t first_node = -1;  ///< -1: the arc is closed, and its first point equals its last
  std::int32_t last_node = -1;
  std::vector<LabelIndex> labels;  ///< sorted, all that meet along it, kBackground among them where it does
  std::uint8_t sides = 0;  ///< bit k: the arc lies on side k of the box; an edge of the box has two bits

  bool is_closed() const { return first_node < 0; }
};

/// A place where the resolution does not suffice to decide which labels meet.
struct UndecidedPlace {
  enum class Reason : std::uint8_t {
    kMissed,       ///< three labels may meet here, and no arc is near
    kUnconfirmed,  ///< an arc passes here, and no point where its labels meet was found near it
    kTooSmall,     ///< a closed arc that is too short to be kept was here
  };
  Voxel block;  ///< the lowest of the eight voxels whose centers surround the place; -1 is outside the grid
  Point point;
  Reason reason;
};

struct LineNetwork {
  std::vector<LineNode> nodes;
  std::vector<LineArc> arcs;
  std::vector<UndecidedPlace> undecided;  ///< at most one per block and reason, in the order of blocks

  /// Length of lines that were contracted to nodes or removed, in voxels along each axis.
  double removed_voxels = 0;
  bool is_whole = true;  ///< false: tracing ended early, and nothing is known

  bool is_empty() const { return arcs.empty(); }
};

/// The arcs for which is_wanted(arc) holds, and the nodes at their ends, in the same order; all else as in
/// the whole network.
LineNetwork part_of(const LineNetwork& network, const std::function<bool(const LineArc&)>& is_wanted);

}  // namespace podm
