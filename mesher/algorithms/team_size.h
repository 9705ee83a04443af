// The number of threads for each purpose. Only this file refuses numbers that options cannot have, and
// decides those that they leave open.
#pragma once

#include <vector>

#include "podm/meshing_options.h"
#include "runtime/placement.h"

namespace podm {

/// True if workers are threads of this machine, neither virtual nor those of a described machine.
bool is_of_this_machine(const TeamOptions& options);

/// Returns the threads of all phases except refinement; 0: all cores. The workers of virtual time are not
/// threads of this machine, unless loops are virtual as well (runtime/virtual_threads.h).
int loop_threads(const TeamOptions& options);

/// Throws InputError if numbers of threads contradict each other or the algorithm.
void check_team_size(const TeamOptions& options, Algorithm algorithm);

/// Returns the number of workers that refine: the threads, if given, otherwise the cores of all computing
/// nodes.
int num_workers(const TeamOptions& options);

/// A team with nothing left open.
struct TeamSize {
  Algorithm algorithm;  // not kAuto
  int num_workers;
  int num_nodes;        // computing nodes, which divide the workers evenly; kPodm has one
  int initial_workers;  // workers that make the initial mesh
};

/// `places` are those of the workers. If the options name no computing nodes, each NUMA node in use is one,
/// provided that they divide the workers evenly.
TeamSize team_size(const MeshingOptions& options, const std::vector<Place>& places);

}  // namespace podm
