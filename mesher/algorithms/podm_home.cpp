// PODM at home: PODM whose computing nodes keep to their own blocks of space.
//
// What PDR.PODM is for is that a computing node finds in its own memory what it works on. It pays with an
// initial mesh, and with nodes that wait for leaves two rings from all others. Here nobody waits: operations
// lock vertices, as in PODM, wherever they are. But a new cell is refined by the node in whose block its
// circumcentre lies, which so makes what lies there, in its own memory; other nodes' memory is touched along
// the blocks' sides alone. Nodes without work take some of others', as beggars do, and send home what they
// make.
//
//   Safety is PODM's, and so is the end of the run: see workers/coordination.h for cells on their way.
#include <optional>
#include <vector>

#include "algorithms/leaf_size.h"
#include "algorithms/perturb.h"
#include "algorithms/podm.h"
#include "geometry/spread_point.h"
#include "refine/virtual_box.h"
#include "workers/work_cost.h"

namespace podm {

namespace {

constexpr std::size_t kSamplesPerHome = 256;

// Cells are expected where the object is, as many in a volume as its bound makes.
std::vector<Homes::Work> expected_work(const Problem& problem, std::size_t num_samples) {
  const Point& low = problem.object.low;
  const Vector extent = problem.object.high - low;
  std::vector<Homes::Work> work;
  for (std::size_t i = 0; i < num_samples; ++i) {
    const Point share = spread_point(i);
    const Point p = low + Vector{extent.x * share.x, extent.y * share.y, extent.z * share.z};
    const LabelIndex label = problem.isosurface.label_at(p);
    if (label == kBackground) continue;
    const double radius = radius_at(problem, label, p);
    work.push_back({p, 1 / (radius * radius * radius)});
  }
  return work;
}

}  // namespace

Refinement podm_home(const Problem& problem, const Team& team, StopControl& stop) {
  const Box clamp = clamp_box(problem.object, problem.delta_mm);
  Construction construction(problem, clamp, team, stop);
  const auto num_homes = static_cast<unsigned>(team.num_nodes);
  std::optional<Homes> homes;
  construction.timed("refine",
                     [&] { homes.emplace(expected_work(problem, kSamplesPerHome * num_homes), num_homes); });
  construction.charge_virtual("refine", &TimeCosts::place_looked_up, kSamplesPerHome * num_homes);
  const Parameters parameters = parameters_for(problem, 1, clamp);
  refine_anywhere(construction, "refine", parameters, construction.all_cells(), construction.num_workers(),
                  &*homes);
  perturb(construction, parameters);
  return construction.finish();
}

}  // namespace podm
