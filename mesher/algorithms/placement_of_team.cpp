#include "algorithms/placement_of_team.h"

#include <algorithm>
#include <set>

#include "algorithms/team_size.h"
#include "podm/errors.h"
#include "runtime/cost_factor.h"

namespace podm {

namespace {

// Adds the groups of one level, unless they distinguish nothing: all workers in one group, or each alone.
void add_level(const std::vector<Place>& places, int Place::*member, WorkerGroups& groups) {
  std::vector<int> level;
  for (const Place& place : places) level.push_back(place.*member);
  const std::size_t num_groups = std::set<int>(level.begin(), level.end()).size();
  if (num_groups > 1 && num_groups < places.size()) groups.push_back(std::move(level));
}

// Sockets may be in nodes or nodes in sockets: the level with more groups is the inner one.
WorkerGroups groups_of(const std::vector<Place>& places) {
  WorkerGroups groups;
  add_level(places, &Place::socket, groups);
  add_level(places, &Place::node, groups);
  const auto num_groups = [](const std::vector<int>& level) {
    return std::set<int>(level.begin(), level.end()).size();
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const auto& a, const auto& b) { return num_groups(a) > num_groups(b); });
  return groups;
}

std::optional<MachineModel> read_model(const TeamOptions& options) {
  const bool has_costs = options.topology_path.ends_with(".toml") && options.executor == Executor::kVirtual;
  if (!options.cost_factor.empty() && !has_costs)
    throw InputError(spelled("cost-factor") + " requires executor virtual and a machine in TOML as " +
                     spelled("topology"));
  if (!options.topology_path.ends_with(".toml")) return std::nullopt;
  MachineModel model = MachineModel::from_file(options.topology_path);
  if (!options.cost_factor.empty()) CostFactor::parse(options.cost_factor).apply_to(model);
  return model;
}

Topology read_topology(const std::string& path, const std::optional<MachineModel>& model) {
  if (model) return model->topology;
  return path.empty() ? Topology::of_this_machine() : Topology::from_file(path);
}

}  // namespace

PlacementOfTeam place_team(const TeamOptions& options) try {
  const std::optional<MachineModel> model = read_model(options);
  PlacementOfTeam placement{.machine = read_topology(options.topology_path, model),
                            .places = {},
                            .groups = {},
                            .model = model,
                            .is_real = is_of_this_machine(options)};
  placement.places = place_workers(placement.machine, PinPlan::parse(options.pin), num_workers(options),
                                   options.oversubscribe || !placement.is_real);
  if (!placement.is_real) {
    for (Place& place : placement.places) place.processor.reset();
  }
  if (options.begging == Begging::kHierarchical) placement.groups = groups_of(placement.places);
  return placement;
} catch (const TopologyError& error) {
  throw InputError(error.what());
} catch (const PlacementError& error) {
  throw InputError(error.what());
}

}  // namespace podm
