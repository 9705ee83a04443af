#include "algorithms/team_size.h"

#include <algorithm>
#include <set>

#include "podm/errors.h"
#include "runtime/virtual_threads.h"

namespace podm {

namespace {

int num_numa_nodes(const std::vector<Place>& places) {
  std::set<int> used;
  for (const Place& place : places) used.insert(place.node);
  return static_cast<int>(used.size());
}

// A home belongs to a computing node, whose workers are consecutive. Returns true if homes are of use: the
// workers of each computing node are on one NUMA node, and those of other computing nodes on others.
bool homes_are_on_nodes(const std::vector<Place>& places) {
  const auto nodes = static_cast<std::size_t>(num_numa_nodes(places));
  if (nodes == 1 || places.size() % nodes != 0) return false;
  const std::size_t per_node = places.size() / nodes;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].node != places[i / per_node * per_node].node) return false;
  return true;
}

// Below the crossover PDR.PODM works exactly as PODM (section 4.3 of its paper), and so does kAuto.
Algorithm algorithm_of(const MeshingOptions& options, int workers, const std::vector<Place>& places) {
  const bool is_auto = options.algorithm == Algorithm::kAuto;
  if (options.crossover > 0) {
    if (workers < options.crossover) return Algorithm::kPodm;
    return is_auto ? Algorithm::kPodmHome : options.algorithm;
  }
  if (!is_auto) return options.algorithm;
  return homes_are_on_nodes(places) ? Algorithm::kPodmHome : Algorithm::kPodm;
}

int num_computing_nodes(const TeamOptions& options, Algorithm algorithm, const std::vector<Place>& places) {
  const int workers = num_workers(options);
  if (algorithm == Algorithm::kPodm) return 1;
  if (algorithm == Algorithm::kPdr) return workers;
  if (options.nodes > 0) return options.nodes;
  if (options.cores_per_node > 0) return workers / options.cores_per_node;
  const int nodes = num_numa_nodes(places);
  return workers % nodes == 0 ? nodes : 1;
}

}  // namespace

bool is_of_this_machine(const TeamOptions& options) {
  return options.executor == Executor::kThreads && options.topology_path.empty();
}

int loop_threads(const TeamOptions& options) {
  const bool are_virtual = options.executor == Executor::kVirtual;
  return are_virtual && VirtualThreads::current() == nullptr ? 0 : options.threads;
}

void check_team_size(const TeamOptions& options, Algorithm algorithm) {
  const int nodes = options.nodes, cores = options.cores_per_node, threads = options.threads;
  if (nodes > 0 && cores > 0 && threads > 0 && nodes * cores != threads)
    throw InputError("the number of threads must equal nodes times cores per node, or be omitted");
  if ((nodes > 0 && threads % nodes != 0) || (cores > 0 && threads % cores != 0))
    throw InputError("nodes and cores per node must divide the number of threads");
  if (algorithm == Algorithm::kPdr && cores > 1)
    throw InputError("pdr has one core per node; use pdr-podm for more");
  if (options.initial_threads > num_workers(options))
    throw InputError("the initial mesh cannot have more threads than the whole run");
}

int num_workers(const TeamOptions& options) {
  if (options.threads > 0) return options.threads;
  return std::max(1, options.nodes) * std::max(1, options.cores_per_node);
}

TeamSize team_size(const MeshingOptions& options, const std::vector<Place>& places) {
  const int workers = num_workers(options.team);
  const Algorithm algorithm = algorithm_of(options, workers, places);
  return {.algorithm = algorithm,
          .num_workers = workers,
          .num_nodes = num_computing_nodes(options.team, algorithm, places),
          .initial_workers = options.team.initial_threads > 0 ? options.team.initial_threads : workers};
}

}  // namespace podm
