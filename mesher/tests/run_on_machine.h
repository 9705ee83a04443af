// Runs on synthetic machines: hwloc's synthetic topologies.
#pragma once

#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "algorithms/image_owners.h"
#include "algorithms/page_sampler.h"
#include "algorithms/podm.h"
#include "image/foreground.h"
#include "tests/images.h"

namespace podm::test {

inline std::uint64_t total(const std::vector<std::uint64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/// A run of this image on that machine, with one worker per core, node after node.
struct RunOn {
  RunOn(const Topology& of_run, int num_workers)
      : machine(of_run),
        placement{.machine = of_run,
                  .places = place_workers(of_run, {}, num_workers, true),
                  .groups = {},
                  .is_real = false} {
    for (Place& place : placement.places) place.processor.reset();
  }

  Refinement operator()(Algorithm algorithm, Executor executor, const PageQuery& query = nullptr,
                        bool with_owners = true) {
    placement.is_real = query != nullptr;
    owners.emplace(owners_of_image(image, isosurface.transform(), placement, 1, query));
    const PageSampler pages(machine, *owners, query);
    const auto num_workers = static_cast<int>(placement.places.size());
    const Team team{.executor = executor,
                    .coordination = {.num_workers = num_workers},
                    .num_nodes = 2,
                    .initial_workers = num_workers,
                    .machine = &machine,
                    .places = placement.places,
                    .owners = with_owners ? &*owners : nullptr,
                    .pages = query ? &pages : nullptr};
    const Problem problem{.isosurface = isosurface,
                          .object = foreground_bounds(image),
                          .delta_mm = 1,
                          .sizes = SizeField({2, 2}),
                          .cell_capacity = 1 << 22};
    StopControl stop({}, {}, [](std::uint64_t) {});
    if (algorithm == Algorithm::kPodm) return podm(problem, team, stop);
    return pdr_podm(problem, team, {}, stop);
  }

  const Topology& machine;
  PlacementOfTeam placement;
  LabelImage image = ball(24, 9);
  Isosurface isosurface{image, 1};
  std::optional<ImageOwners> owners;
};

}  // namespace podm::test
