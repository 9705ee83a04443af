// PODM as a run, and as a phase of the runs of other algorithms. Its loop is in podm_loop.h.
#include "algorithms/podm.h"

#include <algorithm>
#include <cmath>

#include "algorithms/leaf_locks.h"
#include "algorithms/leaf_size.h"
#include "algorithms/mend_topology.h"
#include "algorithms/perturb_mesh.h"
#include "algorithms/podm_loop.h"
#include "algorithms/sample_box.h"
#include "algorithms/sample_lines.h"
#include "refine/virtual_box.h"

namespace podm {

CoordinationOptions coordination_of_first(const Team& team, int num_workers) {
  CoordinationOptions options = team.coordination;
  options.num_workers = num_workers;
  for (std::vector<int>& level : options.groups)
    level.resize(std::min(level.size(), static_cast<std::size_t>(num_workers)));
  return options;
}

namespace {

template <class Locks, class Time>
void refine_with(Construction& construction, const Parameters& parameters, const Construction::Entries& cells,
                 int num_workers, const Homes* homes, Time& time) {
  const auto workers = construction.make_workers<Locks>(parameters, num_workers);
  CoordinationOptions options = coordination_of_first(construction.team(), num_workers);
  if (homes != nullptr) {
    options.workers_per_home = num_workers / static_cast<int>(homes->number());
    for (const auto& worker : workers)
      worker->keep_to(*homes, worker->id() / static_cast<WorkerId>(options.workers_per_home));
  }
  refine(construction, workers, options, cells, time);
}

}  // namespace

void refine_anywhere(Construction& construction, const std::string& phase, const Parameters& parameters,
                     const Construction::Entries& cells, int num_workers, const Homes* homes) {
  if (construction.stop().is_over()) return construction.timed(phase, [] {});  // every run has this phase
  construction.timed(phase, [&] {
    construction.in_time(phase, num_workers, [&](auto& time) {
      if (num_workers > 1 || construction.team().executor == Executor::kVirtual) {
        refine_with<VertexLocks>(construction, parameters, cells, num_workers, homes, time);
      } else {
        refine_with<NoLocks>(construction, parameters, cells, num_workers, homes, time);
      }
    });
  });
  construction.sample_pages(phase);
}

Parameters parameters_for(const Problem& problem, double ratio, const Box& clamp) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  const SizeField sizes = problem.sizes.scaled(ratio);
  const double delta_mm = ratio * problem.delta_mm;
  const auto deltas = ratio == 1 ? problem.deltas : nullptr;  // a coarse mesh keeps no thin layers
  const double least_mm = deltas != nullptr ? deltas->least_mm() : delta_mm;
  const double spacing_mm = std::min(least_mm, std::sqrt(sizes.smallest_squared_radius()) / k);
  return {
      .delta_mm = delta_mm, .sizes = sizes, .clamp_box = clamp, .spacing_mm = spacing_mm, .deltas = deltas};
}

TwoLevels two_levels(const Problem& problem, double initial_ratio) {
  constexpr double kShellOverRadius = 2;  // large balls outside reach over the shell only if they are empty
  const double radius_mm = initial_ratio * least_radius_of_labels(problem),
               shell_mm = kShellOverRadius * radius_mm;
  const Box clamp = grown(problem.object, std::max(2 * initial_ratio * problem.delta_mm, shell_mm));
  TwoLevels levels{clamp, parameters_for(problem, initial_ratio, clamp), parameters_for(problem, 1, clamp)};
  levels.initial.shell_mm = shell_mm;
  levels.initial.shell_radius_mm = radius_mm;
  return levels;
}

Refinement podm(const Problem& problem, const Team& team, StopControl& stop) {
  const Box clamp = clamp_box(problem.object, problem.delta_mm);
  Construction construction(problem, clamp, team, stop);
  Parameters parameters = parameters_for(problem, 1, clamp);
  sample_lines(construction, parameters);
  sample_box(construction, parameters, "refine");
  refine_anywhere(construction, "refine", parameters, construction.all_cells(), construction.num_workers());
  mend_topology(construction, parameters);
  mend_lines(construction, parameters);
  perturb_mesh(construction, parameters);
  return construction.finish();
}

Refinement refine_by(Algorithm algorithm, const Problem& problem, const Team& team, const LeafOptions& leaves,
                     StopControl& stop) {
  switch (algorithm) {
    case Algorithm::kPdr:
      return pdr(problem, team, leaves, stop);
    case Algorithm::kPdrPodm:
      return pdr_podm(problem, team, leaves, stop);
    case Algorithm::kPodmHome:
      return podm_home(problem, team, stop);
    default:
      return podm(problem, team, stop);
  }
}

template bool refine(Worker<NoLocks>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<VertexLocks>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<VertexLocks>&, Coordination&, VirtualTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<NoLocks>>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<NoLocks>>&, Coordination&, VirtualTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<VertexLocks>>&, Coordination&, RealTime&, const std::function<void()>&);
template bool refine(Worker<LeafLocks<VertexLocks>>&, Coordination&, VirtualTime&,
                     const std::function<void()>&);

}  // namespace podm
