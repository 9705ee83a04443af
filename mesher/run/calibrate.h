// Makes a mesh with a target number of cells. Calibration is the time spent on meshes that miss the target.
#pragma once

#include <cstdint>
#include <functional>

#include "podm/meshing_options.h"
#include "podm/meshing_report.h"
#include "prediction/radius_search.h"

namespace podm {

/// The meshes of a search for a radius, made on one machine or on ranks.
struct TrialMeshes {
  std::function<RadiusSearch()> begin_search;
  std::function<StopReason(const SizeOptions& sizes)> make;  ///< `sizes`: radius and delta are not 0
  std::function<std::uint64_t()> count_cells;                ///< cells of the last mesh
  std::function<double()> seconds;                           ///< a clock
};

/// Makes meshes until one has the number of cells that `sizes` requests, or no radius brings it nearer, or
/// the limit of trial meshes is reached. `report` gets the search, and a warning if the target was missed.
/// Ranks that call it together make the same meshes if `meshes` returns the same reasons and numbers on all.
void refine_to_target(const SizeOptions& sizes, const TrialMeshes& meshes, MeshingReport& report);

}  // namespace podm
