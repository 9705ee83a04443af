// The whole refinement on the abdomen phantom: final cells per second, all phases but reading and writing.
#include <benchmark/benchmark.h>

#include "podm/image_io.h"
#include "podm/mesh_image.h"

namespace podm {
namespace {

void BM_mesh_phantom(benchmark::State& state) {
  const LabelImage image = make_phantom("abdomen", 128);
  MeshingOptions options;
  options.radius_mm = static_cast<double>(state.range(0));
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

}  // namespace
}  // namespace podm
