// Segmentations of 3D Slicer (.seg.nrrd): segments, which may overlap, in layers. They are read and merged by
// the verifier's own code.
//
// How an image of one label per voxel follows from a segmentation:
// 1. A segment's label is its LabelValue if these are distinct, otherwise its place in the file, from 1.
// 2. A voxel has the label of the topmost segment that covers it, 0 if there is none.
// 3. Segments that --labels and --drop leave out are below all others. Apart from that, a segment is above
//    those before it in the file; with --layers the layers given are read, each above those before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "image/image.h"
#include "image/label_selection.h"
#include "image/raw_image.h"

namespace podm::verify {

/// Returns the segments by the pairs "SegmentN_Key:=text" of a NRRD header; none if there are no such pairs.
/// Files of several layers without any LabelValue or Layer have one segment per layer, whose voxels are 1.
/// Throws InputError "path: fault" if a segment has no label value, or shares it with another segment of its
/// layer, if a layer is missing, or if a colour or an extent cannot be parsed.
std::vector<Segment> read_segments(const std::string& path, const std::map<std::string, std::string>& pairs,
                                   std::size_t num_layers);

/// Throws InputError if the selection names layers that the image lacks.
void check_layers(const std::string& path, const RawImage& raw, const LabelSelection& selection);

/// Fills the voxels of an image of the same size from several layers. Also adds to `covered_labels` every
/// label with a voxel that another segment has. Throws InputError if a voxel has a value of no segment in its
/// layer.
void merge_layers(RawImage& raw, const LabelSelection& selection, Image& image);

}  // namespace podm::verify
