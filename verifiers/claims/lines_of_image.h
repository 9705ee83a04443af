// Points of the lines where three or more labels of the image's label function meet (image/label_function.h).
//
// In the block between eight voxel centers the weight of a label is trilinear. On a box in the block the
// difference of two weights is trilinear, too, and takes its least and largest value at corners of the box. A
// label that is below another one at all eight corners is therefore greatest nowhere in the box. A box in
// which fewer than three labels are left has no point of a line. Other boxes are cut in eight, down to a
// floor. A box of the floor with three labels that are greatest at its corners stands for a point of a line,
// at its center. A box of the floor in which other labels may be greatest, too, is undecided.
//
// On the sides of a flat box, lines are where two labels besides background meet in the plane. They are found
// in blocks from the outermost voxel centers outwards, with background at the outer corners, and moved to the
// plane: along the axis the weights of the labels in the plane keep their proportions.
#pragma once

#include <vector>

#include "image/image_frame.h"
#include "image/label_function.h"

namespace podm::verify {

struct LinePoint {
  Point voxels{}, world{};
  std::vector<std::uint32_t> labels;  ///< ascending; three or more
  bool is_decided = true;             ///< three labels are greatest at corners of the box
};

/// The largest side of a box of the floor, voxels.
double side_of_floor_voxels();

/// Returns the points of the lines of an image, slice by slice, in the same order on any number of threads.
std::vector<LinePoint> lines_of_image(const Image& image, const ImageFrame& frame, int threads);

}  // namespace podm::verify
