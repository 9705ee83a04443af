// Insertion and removal in a box refined to a uniform size: the kernel without image and rules.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "delaunay/operation.h"

namespace podm {
namespace {

// Inserts circumcenters, moved off the hull, of cells with a circumradius above `radius`, last in first out.
class UniformRefinement {
 public:
  explicit UniformRefinement(double radius) : squared_radius_(radius * radius), min_distance_(radius / 2) {
    for (CellId c = 0; c < 6; ++c) poor_.push_back({c, mesh.stamp(c)});
  }

  void refine() {
    while (!poor_.empty()) {
      const auto [c, stamp] = poor_.back();
      poor_.pop_back();
      if (mesh.stamp(c) != stamp) continue;
      const Cell& cell = mesh.cell(c);
      if (cell.squared_radius <= squared_radius_) continue;
      const Point p = moved_off_the_hull(cell.center);
      if (operation.plan_insertion(p, c) != StepResult::kDone ||
          operation.commit_insertion(p, VertexKind::kCircumcenter, min_distance_) != StepResult::kDone) {
        operation.rollback();
        continue;
      }
      ++num_insertions;
      for (const CellId made : operation.created()) poor_.push_back({made, mesh.stamp(made)});
    }
  }

  Mesh mesh{{{0, 0, 0}, {1, 1, 1}}, 1 << 22};
  Pool pool{mesh};
  Operation<NoLocks> operation{mesh, pool, 0};
  std::int64_t num_insertions = 0;

 private:
  static Point moved_off_the_hull(const Point& p) {
    const auto moved = [](double x) { return std::clamp(x, 0.01, 0.99); };
    return {moved(p.x), moved(p.y), moved(p.z)};
  }
  struct Entry {
    CellId cell;
    std::uint32_t stamp;
  };
  double squared_radius_, min_distance_;
  std::vector<Entry> poor_;
};

void BM_insertion(benchmark::State& state) {
  std::int64_t insertions = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto refinement = std::make_unique<UniformRefinement>(0.025);
    state.ResumeTiming();
    refinement->refine();
    insertions += refinement->num_insertions;
    state.PauseTiming();
    refinement.reset();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(insertions);
}
BENCHMARK(BM_insertion)->Unit(benchmark::kMillisecond);

// Inserts a vertex into every sixteenth cell and removes one of the cell's own, as R1 and R3 do with R6.
void BM_insertion_with_removal(benchmark::State& state) {
  std::int64_t removals = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto refinement = std::make_unique<UniformRefinement>(0.04);
    refinement->refine();
    Mesh& mesh = refinement->mesh;
    state.ResumeTiming();
    for (CellId c = 0; c < mesh.cell_bound(); ++c) {
      if (!mesh.cell(c).is_alive() || c % 16 != 0) continue;
      const auto vertices = mesh.cell(c).vertices;
      if (mesh.vertex(vertices[0]).kind != VertexKind::kCircumcenter) continue;
      Point middle = 0.25 * mesh.point(vertices[0]);
      for (unsigned i = 1; i < 4; ++i) middle = middle + 0.25 * mesh.point(vertices[i]);
      refinement->operation.plan_insertion(middle, c);
      refinement->operation.plan_removal(vertices[0], c);
      refinement->operation.commit_insertion(middle, VertexKind::kCircumcenter, 0);
      ++removals;
    }
    state.PauseTiming();
    refinement.reset();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(removals);
}
BENCHMARK(BM_insertion_with_removal)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace podm
