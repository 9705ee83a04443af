// PODM at home: PODM whose computing nodes each refine their own block of space.
//
// The purpose of PDR.PODM is that a computing node finds in its own memory the cells that it works on. It
// pays with an initial mesh, and with nodes that wait for leaves beyond two rings of all active ones. Here no
// node waits: operations lock vertices anywhere, as in PODM. A new cell, however, is refined by the node
// whose block contains its circumcenter. That node therefore makes the cells of its block in its own memory,
// and accesses the memory of other nodes only along the block's sides. Nodes without work take cells of other
// nodes, as begging workers do, and send home the cells that they make.
//
//   Safety and the end of the run are those of PODM: see workers/coordination.h for cells on their way.
#include <optional>
#include <vector>

#include "algorithms/leaf_size.h"
#include "algorithms/mend_topology.h"
#include "algorithms/perturb_mesh.h"
#include "algorithms/podm.h"
#include "algorithms/sample_box.h"
#include "algorithms/sample_lines.h"
#include "geometry/spread_point.h"
#include "refine/virtual_box.h"

namespace podm {

namespace {

constexpr std::size_t kSamplesPerHome = 256;

// Expects cells inside the object, with a density per volume that follows from the circumradius bound.
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
  construction.timed("refine", [&] {
    const std::size_t num_samples = kSamplesPerHome * num_homes;
    homes.emplace(expected_work(problem, num_samples), num_homes);
    return looking_up_places(num_samples);
  });
  Parameters parameters = parameters_for(problem, 1, clamp);
  sample_lines(construction, parameters);
  sample_box(construction, parameters, "refine");
  refine_anywhere(construction, "refine", parameters, construction.all_cells(), construction.num_workers(),
                  &*homes);
  mend_topology(construction, parameters);
  mend_lines(construction, parameters);
  perturb_mesh(construction, parameters);
  return construction.finish();
}

}  // namespace podm
