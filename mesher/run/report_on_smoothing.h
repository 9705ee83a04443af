// Reports the effect of smoothing on each label: its volume and its components, before and after.
#pragma once

#include "podm/label_image.h"
#include "podm/meshing_report.h"
#include "smoothing/smooth_interfaces.h"

namespace podm {

/// Labels are in the order of LabelImage::labels, without the background. `threads`: 0 for all cores; the
/// report is the same for any number.
///
/// Components by faces stay as they are (voxel_weights.h). Two components that touch along an edge or at a
/// corner may grow together. They count as one if a straight path between two of their voxels keeps the
/// label.
SmoothingReport report_on_smoothing(const LabelImage& image, double width_mm,
                                    const SmoothInterfaces& smoothed, int threads);

}  // namespace podm
