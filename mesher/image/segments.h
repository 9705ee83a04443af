// The segments in the header of a segmentation that 3D Slicer wrote (.seg.nrrd).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// Returns the segments that the fields "SegmentN_Name", "SegmentN_LabelValue", "SegmentN_Layer" and
/// "SegmentN_Color" describe, by N; empty if there is none. Their labels have the stored values if these are
/// distinct, otherwise 1, 2, 3 ... in this order.
///
/// Files of several layers in which no segment has a value or a layer come from versions of 3D Slicer before
/// 5: segment N is layer N, and its voxels are 1.
///
/// Throws InputError that names `path`, the field and the fault if a value is missing or not a positive
/// integer, a layer is missing, two segments of a layer have the same value, or an extent or colour cannot be
/// parsed.
std::vector<Segment> parse_segments(const std::string& path, const std::map<std::string, std::string>& fields,
                                    std::size_t num_layers);

/// True if labels have other values than the voxels of the file.
bool are_renumbered(const std::vector<Segment>& segments);

/// The name if there is one, otherwise the number among the segments: "segment 'Ulna'", "segment 3".
std::string text_of_segment(const std::vector<Segment>& segments, std::size_t number);

}  // namespace podm
