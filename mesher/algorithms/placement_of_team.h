// The places of a run's workers in a machine.
#pragma once

#include <optional>
#include <vector>

#include "podm/meshing_options.h"
#include "runtime/machine_model.h"
#include "runtime/placement.h"
#include "runtime/topology.h"
#include "workers/begging_list.h"

namespace podm {

struct PlacementOfTeam {
  Topology machine;  // this machine, or the described one
  std::vector<Place> places;
  WorkerGroups groups;                     // as the begging list requires them
  std::optional<MachineModel> model = {};  // of the described machine, if its description includes costs
  bool is_real = true;  // workers are threads of this machine, not virtual and not of a described machine
};

/// Returns a place for each worker. Virtual workers and workers of a described machine are not bound. Throws
/// InputError on a plan, machine or number of workers that is not available.
PlacementOfTeam place_team(const TeamOptions& options);

}  // namespace podm
