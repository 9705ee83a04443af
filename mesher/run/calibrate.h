// Makes a mesh with a target number of cells. Calibration is the time spent on meshes that miss the target.
#pragma once

#include <functional>

#include "algorithms/construction.h"
#include "isosurface/isosurface.h"
#include "podm/meshing_options.h"

namespace podm {

/// Makes a mesh with these sizes, whose radius and delta are not 0.
using MakeMesh = std::function<Refinement(const SizeOptions& sizes)>;

/// Makes meshes until one has the number of cells that `sizes` requests, or no radius brings it nearer, or
/// the limit of trial meshes is reached. Returns the last mesh. `report` gets the search, and a warning if
/// the target was missed. `threads`: 0 for all cores.
Refinement refine_to_target(const LabelImage& image, const Isosurface& isosurface, const SizeOptions& sizes,
                            int threads, const MakeMesh& make_mesh, MeshingReport& report);

}  // namespace podm
