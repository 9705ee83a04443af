// A mesh of a target number of cells. What is spent on meshes that miss it is calibration.
#pragma once

#include <functional>

#include "algorithms/construction.h"
#include "isosurface/isosurface.h"
#include "podm/meshing_options.h"

namespace podm {

/// Makes a mesh with these sizes, whose radius and delta are not 0.
using MakeMesh = std::function<Refinement(const SizeOptions& sizes)>;

/// Makes meshes until one has as many cells as `sizes` ask for, or no radius brings it nearer, and returns
/// the last. Tells of the search, and of a target that was not met, in `report`. `threads`: 0 for all cores.
Refinement refine_to_target(const LabelImage& image, const Isosurface& isosurface, const SizeOptions& sizes,
                            int threads, const MakeMesh& make_mesh, MeshingReport& report);

}  // namespace podm
