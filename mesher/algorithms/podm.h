// The algorithms. Each turns the six cells of a box into a mesh of an image that obeys R1 to R6.
#pragma once

#include "algorithms/construction.h"
#include "podm/meshing_options.h"

namespace podm {

/// Parallel Optimistic Delaunay Meshing: all workers refine anywhere at the same time. With one worker it is
/// sequential and takes no locks.
Refinement podm(const Problem& problem, const Team& team, StopControl& stop);

/// PODM whose computing nodes each refine their own block of space.
Refinement podm_home(const Problem& problem, const Team& team, StopControl& stop);

/// Parallel Delaunay refinement leaf by leaf, with one worker per leaf and without locks.
Refinement pdr(const Problem& problem, const Team& team, const LeafOptions& options, StopControl& stop);
/// PDR with several workers per leaf, which lock vertices against each other.
Refinement pdr_podm(const Problem& problem, const Team& team, const LeafOptions& options, StopControl& stop);

/// Runs the given algorithm, which must not be kAuto.
Refinement refine_by(Algorithm algorithm, const Problem& problem, const Team& team, const LeafOptions& leaves,
                     StopControl& stop);

/// PODM's loop, for one worker of a group. Returns true if all cells of the group are refined, which the
/// master learns, or if the worker was dismissed. Returns false if the run is over. `before_begging`, if
/// given, is called each time that the worker has no cells left.
template <class Locks, class Time>
bool refine(Worker<Locks>& worker, Coordination& group, Time& time,
            const std::function<void()>& before_begging = {});

/// Returns the coordination of the first `num_workers` workers of a team. Their groups contain only these
/// workers.
CoordinationOptions coordination_of_first(const Team& team, int num_workers);

/// PODM as a phase: the first `num_workers` workers of the team refine these cells, with locks unless there
/// is only one thread. Homes, if given, divide the workers evenly, in order.
void refine_anywhere(Construction& construction, const std::string& phase, const Parameters& parameters,
                     const Construction::Entries& cells, int num_workers, const Homes* homes = nullptr);

/// Returns the rules' parameters for the problem, with all bounds multiplied by `ratio`.
Parameters parameters_for(const Problem& problem, double ratio, const Box& clamp_box);
/// Parameters of a coarse mesh, which also bounds cells around the object, and of the mesh that refines it.
struct TwoLevels {
  Box clamp;
  Parameters initial, final;
};
TwoLevels two_levels(const Problem& problem, double initial_ratio);

}  // namespace podm
