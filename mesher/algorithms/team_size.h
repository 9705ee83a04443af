// How many threads do what. Here alone is refused what options ask for in vain, and decided what they leave
// open.
#pragma once

#include <vector>

#include "podm/meshing_options.h"
#include "runtime/placement.h"

namespace podm {

/// Whether workers are threads of this machine, neither virtual ones nor those of a described machine.
bool is_of_this_machine(const TeamOptions& options);

/// Threads of all phases but refinement; 0: all cores. The threads of virtual time are none of this
/// machine's.
int loop_threads(const TeamOptions& options);

/// Throws InputError where numbers of threads contradict each other or the algorithm.
void check_team_size(const TeamOptions& options, Algorithm algorithm);

/// Workers that refine: as many as threads, else as all computing nodes have cores.
int num_workers(const TeamOptions& options);

/// A team of which nothing is left open.
struct TeamSize {
  Algorithm algorithm;  // not kAuto
  int num_workers;
  int num_nodes;        // computing nodes, which divide the workers evenly; kPodm has one
  int initial_workers;  // so many make the initial mesh
};

/// `places` are those of the workers: where options name no computing nodes, each NUMA node in use is one, if
/// these divide the workers evenly.
TeamSize team_size(const MeshingOptions& options, const std::vector<Place>& places);

}  // namespace podm
