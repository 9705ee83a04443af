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
  Topology machine;  // this one, or the one described
  std::vector<Place> places;
  WorkerGroups groups;                     // as the begging list needs them
  std::optional<MachineModel> model = {};  // of the described machine, where its description tells costs
  bool is_real = true;  // threads of this machine, neither virtual workers nor those of a described one
};

/// A place for each worker. Those of a described machine, and virtual ones, are bound to nothing.
/// Throws InputError on a plan, machine or number that cannot be had.
PlacementOfTeam place_team(const TeamOptions& options);

}  // namespace podm
