// PODM: Foteinos, Chrisochoides, JPDC 74 (2014) 2123-2140.
#include "podm.h"

#include <algorithm>
#include <cmath>

#include "refine/virtual_box.h"

namespace podm {

Parameters parameters_for(const Problem& problem, double ratio, const Box& clamp) {
  const double k = std::sqrt(2 + std::sqrt(3.0));
  const SizeField sizes = problem.sizes.scaled(ratio);
  const double delta_mm = ratio * problem.delta_mm;
  const double spacing_mm = std::min(delta_mm, std::sqrt(sizes.smallest_squared_radius()) / k);
  return {delta_mm, sizes, clamp, spacing_mm};
}

Refinement podm(const Problem& problem, const Crew& crew, Watch& watch) {
  const Box clamp = clamp_box(problem.object, problem.delta_mm);
  const Parameters parameters = parameters_for(problem, 1, clamp);
  Refiner refiner(problem, clamp, crew, watch);
  refiner.refine_anywhere("refine", parameters, refiner.all_cells(), refiner.num_workers());
  return refiner.finish();
}

}  // namespace podm
