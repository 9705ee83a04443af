// What smoothing made of each label: its volume and its components, before and after.
#pragma once

#include "podm/label_image.h"
#include "podm/meshing_report.h"
#include "smoothing/smooth_interfaces.h"

namespace podm {

/// By labels as in LabelImage::labels, but the background. `threads`: 0 for all cores; the report is the same
/// for any number.
///
/// Components by faces stay what they are (voxel_strengths.h), but two that touch along an edge or at a
/// corner may grow together: they count as one where a straight way between two of their voxels keeps the
/// label.
SmoothingReport report_on_smoothing(const LabelImage& image, double width_mm,
                                    const SmoothInterfaces& smoothed, int threads);

}  // namespace podm
