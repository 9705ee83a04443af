// Canonical order, hash and file writing of a mesh of about 3 M cells.
#include <benchmark/benchmark.h>

#include "io/tests/kuhn_mesh.h"
#include "podm/mesh_io.h"
#include "tests/scratch_folder.h"

namespace podm {
namespace {

// Random order is the worst case of canonicalize(): a refined mesh has some locality.
const TetMesh& shuffled_mesh() {
  static const TetMesh mesh = shuffled(make_test_mesh(80), 1);
  return mesh;
}

const TetMesh& canonical_mesh() {
  static const TetMesh mesh = [] {
    TetMesh copy = shuffled_mesh();
    canonicalize(copy);
    return copy;
  }();
  return mesh;
}

void set_cells(benchmark::State& state, const TetMesh& mesh) {
  state.counters["cells"] = static_cast<double>(mesh.cells.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.cells.size()));
}

void BM_Canonicalize(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    TetMesh mesh = shuffled_mesh();
    state.ResumeTiming();
    canonicalize(mesh);
  }
  set_cells(state, shuffled_mesh());
}
BENCHMARK(BM_Canonicalize)->Unit(benchmark::kMillisecond);

void BM_MeshSha256(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(mesh_sha256(canonical_mesh()));
  set_cells(state, canonical_mesh());
}
BENCHMARK(BM_MeshSha256)->Unit(benchmark::kMillisecond);

// The real time includes the wait until the file is on the disk; the processor time does not.
void BM_WriteMesh(benchmark::State& state, const char* name, const MeshFileOptions& options = {}) {
  const ScratchFolder folder;
  const TetMesh& mesh = canonical_mesh();  // made before the clock starts
  for (auto _ : state) write_mesh(mesh, folder / name, options);
  set_cells(state, mesh);
}
BENCHMARK_CAPTURE(BM_WriteMesh, vtu, "a.vtu")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, legacy_vtk, "a.vtk")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, medit, "a.mesh")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, gmsh, "a.msh")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, xdmf, "a.xdmf")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, abaqus, "a.inp")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, exodus, "a.e")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, tetgen, "a.ele")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WriteMesh, gmsh_v2, "a.msh", {GmshVersion::k2_2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace podm
