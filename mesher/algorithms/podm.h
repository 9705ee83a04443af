// The algorithms. Each brings an image from the six cells of a box to a mesh that obeys R1..R6.
#pragma once

#include "algorithms/construction.h"
#include "podm/meshing_options.h"

namespace podm {

/// Parallel Optimistic Delaunay Meshing: all workers anywhere at once. On one worker it is sequential,
/// without locks.
Refinement podm(const Problem& problem, const Team& team, StopControl& stop);

/// PODM whose computing nodes keep to their own blocks of space.
Refinement podm_home(const Problem& problem, const Team& team, StopControl& stop);

/// Parallel Delaunay refinement leaf by leaf, one worker a leaf, without locks.
Refinement pdr(const Problem& problem, const Team& team, const LeafOptions& options, StopControl& stop);
/// The same with several workers a leaf, which lock vertices against each other.
Refinement pdr_podm(const Problem& problem, const Team& team, const LeafOptions& options, StopControl& stop);

/// By one of these; not kAuto.
Refinement refine_by(Algorithm algorithm, const Problem& problem, const Team& team, const LeafOptions& leaves,
                     StopControl& stop);

/// PODM's loop, for one worker of a group. True: all cells that the group had are refined, as its master is
/// told, or the worker was dismissed. False: the run is over. `before_begging`, if given, is called each time
/// that the worker has no cells left.
template <class Locks, class Time>
bool refine(Worker<Locks>& worker, Coordination& group, Time& time,
            const std::function<void()>& before_begging = {});

/// How the first workers of a team coordinate; the groups are theirs alone.
CoordinationOptions coordination_of_first(const Team& team, int num_workers);

/// PODM as a phase: the first `num_workers` of the team refine these cells, with locks unless there is only
/// one. Homes, if given, divide the workers evenly, in their order.
void refine_anywhere(Construction& construction, const std::string& phase, const Parameters& parameters,
                     const Construction::Entries& cells, int num_workers, const Homes* homes = nullptr);

/// Rules for the problem, with all bounds times `ratio`.
Parameters parameters_for(const Problem& problem, double ratio, const Box& clamp_box);
/// Rules for a coarse mesh, which bounds cells around the object too, and for the mesh that refines it.
struct TwoLevels {
  Box clamp;
  Parameters initial, final;
};
TwoLevels two_levels(const Problem& problem, double initial_ratio);

}  // namespace podm
