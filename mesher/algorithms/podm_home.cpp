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
#include <algorithm>
#include <cmath>

#include "algorithms/leaf_size.h"
#include "algorithms/podm.h"
#include "refine/virtual_box.h"
#include "workers/work_cost.h"

namespace podm {

namespace {

// Cells are expected where the object is, as many in a volume as its bound makes.
std::vector<Homes::Work> expected_work(const Problem& problem, std::size_t num_samples) {
  const Radii radii = radii_of(problem);
  const Point& low = problem.object.low;
  const Vector extent = problem.object.high - low;
  const double step = std::cbrt(extent.x * extent.y * extent.z / static_cast<double>(num_samples));
  const auto along = [&](double length) { return std::max(1, static_cast<int>(std::lround(length / step))); };
  const int nx = along(extent.x), ny = along(extent.y), nz = along(extent.z);
  std::vector<Homes::Work> work;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const Point p =
            low + Vector{extent.x * (i + 0.5) / nx, extent.y * (j + 0.5) / ny, extent.z * (k + 0.5) / nz};
        const LabelIndex label = problem.isosurface.label_at(p);
        if (label == kBackground) continue;
        const double radius = radii.of_label[label - 1u];
        work.push_back({p, 1 / (radius * radius * radius)});
      }
  return work;
}

constexpr std::size_t kSamplesPerHome = 256;

}  // namespace

Refinement podm_home(const Problem& problem, const Team& team, StopControl& stop) {
  const Box clamp = clamp_box(problem.object, problem.delta_mm);
  Construction construction(problem, clamp, team, stop);
  const auto num_homes = static_cast<unsigned>(team.num_nodes);
  std::optional<Homes> homes;
  construction.timed("refine",
                     [&] { homes.emplace(expected_work(problem, kSamplesPerHome * num_homes), num_homes); });
  construction.charge_virtual("refine", kPlaceLookedUp * static_cast<double>(kSamplesPerHome * num_homes));
  refine_anywhere(construction, "refine", parameters_for(problem, 1, clamp), construction.all_cells(),
                  construction.num_workers(), &*homes);
  return construction.finish();
}

}  // namespace podm
