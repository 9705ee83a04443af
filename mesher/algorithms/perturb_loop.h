// R7's loop: rounds in which workers try to move vertices of poor cells, with growing effort.
//
// Sources that bring their own locks include this file. All other sources include perturb_mesh.h.
#pragma once

#include "algorithms/podm_loop.h"

namespace podm {

inline constexpr const char* kPerturb = "perturb";  // the phase

// The few cells that the first round leaves justify more points, and more distant ones.
inline constexpr std::array kMoveEfforts{MoveEffort{12, 0.25}, MoveEffort{36, 0.4}, MoveEffort{36, 0.4},
                                         MoveEffort{36, 0.4}, MoveEffort{36, 0.4}};

template <class Locks>
void begin_perturbation(Construction& construction, const Construction::Workers<Locks>& workers) {
  const std::uint64_t seed = construction.team().coordination.seed;
  for (const auto& worker : workers)
    worker->begin_perturbation(*construction.problem().dihedral_bounds, seed + worker->id());
}

// Returns false if the run is over or there was nothing to try.
template <class Locks, class Time>
bool try_listed(Construction& construction, const Construction::Workers<Locks>& workers,
                const MoveEffort& effort, Time& time) {
  bool has_work = false;
  for (const auto& worker : workers) {
    worker->perturbation().set_effort(effort);
    has_work = has_work || worker->has_work();
  }
  if (!has_work) return false;
  Coordination group(coordination_of_first(construction.team(), static_cast<int>(workers.size())),
                     [&](WorkerId worker) { time.resume(worker); });
  time.run([&](WorkerId self) {
    if (refine(*workers[self], group, time) && self == 0) group.dismiss();
  });
  return !time.is_over();
}

/// Tries to move vertices of the cells that the workers have. Each worker keeps the cells that the last round
/// could not change (Worker::take_kept).
template <class Locks, class Time>
void perturb_listed(Construction& construction, const Construction::Workers<Locks>& workers, Time& time) {
  const Mesh& mesh = construction.mesh();
  for (const MoveEffort& effort : kMoveEfforts) {
    if (!try_listed(construction, workers, effort, time)) return;
    if (&effort == &kMoveEfforts.back()) return;
    for (const auto& worker : workers)
      for (const auto& [entry, why] : worker->take_kept())
        if (mesh.stamp(entry.cell) == entry.stamp) worker->give(entry.cell);
  }
}

}  // namespace podm
