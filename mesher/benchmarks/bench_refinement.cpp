// The whole refinement of the abdomen phantom: final cells per second over all phases except reading and
// writing; and the cost of vertex locks for a worker without lock conflicts.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "algorithms/podm.h"
#include "image/foreground.h"
#include "podm/image_io.h"
#include "podm/mesh_image.h"
#include "refine/virtual_box.h"
#include "runtime/processor_seconds.h"

namespace podm {
namespace {

void BM_mesh_phantom(benchmark::State& state) {
  const LabelImage image = make_phantom("abdomen", 128);
  const MeshingOptions options{.sizes = {.radius_mm = static_cast<double>(state.range(0))}};
  std::int64_t cells = 0;
  double refine_s = 0;
  for (auto _ : state) {
    const MeshingResult result = mesh_image(image, options);
    cells += static_cast<std::int64_t>(result.mesh.cells.size());
    refine_s += result.report.phases_s.at("refine");
  }
  state.SetItemsProcessed(cells);
  state.counters["cells"] = static_cast<double>(cells) / static_cast<double>(state.iterations());
  state.counters["refine_cells_per_second"] = static_cast<double>(cells) / refine_s;
}
BENCHMARK(BM_mesh_phantom)->Arg(8)->Arg(5)->Unit(benchmark::kMillisecond);

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Locks>
double refine_s(Construction& construction, const Construction::Workers<Locks>& workers) {
  RealTime time(construction.stop(), 1, {});
  Coordination group({}, [](WorkerId) {});
  workers[0]->give(construction.all_cells());
  const double start_s = processor_seconds();
  refine(*workers[0], group, time);
  return processor_seconds() - start_s;
}

// Runs the same worker with and without locks once per iteration, in alternating order. Compares the fastest
// run of each, which load on the machine affects least. To compare instructions, run one iteration under
// `valgrind --tool=callgrind` and compare the two refine(), inclusive.
void BM_cost_of_locks(benchmark::State& state) {
  const LabelImage image = make_phantom("abdomen", 128);
  const Isosurface isosurface(image, 0);
  const double radius_mm = static_cast<double>(state.range(0));
  const SizeField sizes(std::vector<double>(image.labels.size(), radius_mm));
  std::uint64_t cells = 0;
  const auto seconds_of = [&](bool with_locks) {
    StopControl stop({}, {}, [](std::uint64_t) {});
    const Team team;
    const Problem problem{.isosurface = isosurface,
                          .object = foreground_bounds(image),
                          .delta_mm = default_delta_mm(image, radius_mm),
                          .sizes = sizes,
                          .cell_capacity = 1 << 24};
    const Box clamp = clamp_box(problem.object, problem.delta_mm);
    Construction construction(problem, clamp, team, stop);
    const Parameters parameters = parameters_for(problem, 1, clamp);
    const double seconds = with_locks
                               ? refine_s(construction, construction.make_workers<VertexLocks>(parameters, 1))
                               : refine_s(construction, construction.make_workers<NoLocks>(parameters, 1));
    cells = construction.mesh().num_cells();
    return seconds;
  };
  std::array<double, 2> fastest_s{kInfinity, kInfinity};  // without locks, with locks
  bool with_locks_first = false;
  for (auto _ : state) {
    for (const bool with_locks : {with_locks_first, !with_locks_first})
      fastest_s[with_locks] = std::min(fastest_s[with_locks], seconds_of(with_locks));
    with_locks_first = !with_locks_first;
  }
  state.counters["store_cells"] = static_cast<double>(cells);
  state.counters["without_s"] = fastest_s[0];
  state.counters["with_s"] = fastest_s[1];
  state.counters["ratio"] = fastest_s[1] / fastest_s[0];
}
BENCHMARK(BM_cost_of_locks)->ArgName("radius_mm")->Arg(16)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_cost_of_locks)->ArgName("radius_mm")->Arg(5)->Iterations(11)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace podm
