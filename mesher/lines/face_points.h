// Points on a face of a block where three labels tie: where curves pass from block to block, or end at a side
// of the box.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "lines/few_labels.h"
#include "lines/weight_forms.h"

namespace podm {

/// A triangle of the face's lattice with three labels, in the axes of forms_on_face().
struct FaceTriangle {
  std::uint8_t u, v;    // steps to its lowest vertex
  bool is_second;       // its middle vertex is one step along v, not u
  std::uint16_t index;  // by which the caller knows the triangle
  FewLabels labels;
};

struct FacePoint {
  Point uv;
  FewLabels labels;
  bool is_confirmed;  // the labels of some triangle tie here
  std::vector<std::uint16_t> triangles;
};

/// Finds the points near the triangles. Points closer than kMergeDistance are one. The result depends only on
/// the face's forms and on the set of triangles, not on their order, and so is the same for both blocks.
std::vector<FacePoint> face_points(const WeightForms& forms, const Box& box,
                                   std::vector<FaceTriangle> triangles);

}  // namespace podm
