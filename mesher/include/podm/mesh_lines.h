// The lines of a mesh: edges along which three or more labels meet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// Empty unless lines were asked for. A line is the set of all edges along which the same labels meet.
struct MeshLines {
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< positions of vertices, the smaller one first
  std::vector<std::uint32_t> line_of_edge;          ///< one per edge, position in `labels_of_line`
  /// Three or more labels each, in ascending order, 0 is outside. No two lines have the same labels.
  std::vector<std::vector<LabelIndex>> labels_of_line;
  double delta_mm = 0;       ///< distance at which lines were sampled, mm
  bool are_claimed = false;  ///< at most 0.1 % of the lines is missing, and of the edges is not on lines

  /// True if lines were asked for, also if the image has none.
  bool are_kept() const { return delta_mm > 0; }
};

}  // namespace podm
