// A small mesh to optimise, and the properties that optimisation must keep.
#pragma once

#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <vector>

#include "algorithms/podm.h"
#include "image/foreground.h"
#include "isosurface/isosurface.h"
#include "optimize/obstacles.h"
#include "optimize/optimize_mesh.h"
#include "tests/images.h"

namespace podm::test {

inline CellPoints points_of(const Mesh& mesh, CellId c) {
  const auto& v = mesh.cell(c).vertices;
  return {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])};
}

inline const DihedralBounds kBounds{8, 165};

/// The mesh is refined by one worker; all its cells have labels.
class MeshToOptimize {
 public:
  MeshToOptimize(const LabelImage& image, double radius_mm, double delta_mm)
      : isosurface_(image, 1),
        parameters_{OptimizationQuality(aim_over(kBounds)), kBounds,
                    SizeField(std::vector<double>(image.labels.size(), radius_mm)), delta_mm} {
    const Problem problem{.isosurface = isosurface_,
                          .object = foreground_bounds(image),
                          .delta_mm = delta_mm,
                          .sizes = parameters_.sizes,
                          .cell_capacity = 1 << 19};
    StopControl stop({}, {}, [](std::uint64_t) {});
    mesh_ = podm::podm(problem, {.coordination = {.num_workers = 1}}, stop).mesh;
    for (CellId c = 0; c < mesh_->cell_bound(); ++c)
      if (mesh_->cell(c).is_alive()) mesh_->label(c) = isosurface_.label_at(mesh_->cell(c).center);
  }

  Mesh& mesh() { return *mesh_; }
  const OptimizerParameters& parameters() const { return parameters_; }

  OptimizationReport optimize(Executor executor, int num_workers, std::uint64_t seed, StopControl& stop) {
    const Team team{.executor = executor, .coordination = {.num_workers = num_workers, .seed = seed}};
    return optimize_mesh(*mesh_, parameters_, team, stop);
  }

  template <class Visit>
  void for_each_cell(const Visit& visit) const {
    for (CellId c = 0; c < mesh_->cell_bound(); ++c)
      if (mesh_->cell(c).is_alive() && mesh_->label(c) != kBackground) visit(c);
  }
  double worst_quality() const {
    double worst = 1e300;
    for_each_cell([&](CellId c) { worst = std::min(worst, parameters_.aim.of(points_of(*mesh_, c))); });
    return worst;
  }
  std::uint64_t num_beyond(const DihedralBounds& bounds) const {
    std::uint64_t count = 0;
    for_each_cell([&](CellId c) { count += bounds.quality(points_of(*mesh_, c).dihedral()) < 1; });
    return count;
  }
  /// The number of cells that violate the bound on ratio or size, in rounded arithmetic.
  std::uint64_t num_over_bounds() const {
    std::uint64_t count = 0;
    for_each_cell([&](CellId c) {
      const auto [a, b, p, d] = points_of(*mesh_, c);
      const double radius2 = circumsphere(a, b, p, d, 0).squared_radius;
      double shortest2 = 1e300;
      for (const auto& [x, y] : {std::pair{a, b}, {a, p}, {a, d}, {b, p}, {b, d}, {p, d}})
        shortest2 = std::min(shortest2, squared_distance(x, y));
      count +=
          radius2 >= kRadiusEdgeBound * kRadiusEdgeBound * shortest2 ||
          radius2 > parameters_.sizes.squared_radius(mesh_->label(c), circumsphere(a, b, p, d, 0).center);
    });
    return count;
  }
  std::vector<double> volumes() const {
    std::vector<double> volumes(parameters_.sizes.num_labels());
    for_each_cell(
        [&](CellId c) { volumes[mesh_->label(c)] += points_of(*mesh_, c).dihedral().determinant / 6; });
    return volumes;
  }
  /// The facets between labels by their vertices, with the larger label before the smaller.
  std::map<std::array<VertexId, 3>, std::array<LabelIndex, 2>> interface_facets() const {
    std::map<std::array<VertexId, 3>, std::array<LabelIndex, 2>> facets;
    for_each_cell([&](CellId c) {
      const Cell& cell = mesh_->cell(c);
      for (unsigned k = 0; k < 4; ++k) {
        const LabelIndex across = mesh_->label(cell_of(cell.mirrors[k])), own = mesh_->label(c);
        if (across >= own) continue;
        std::array<VertexId, 3> facet;
        for (unsigned i = 0; i < 3; ++i)
          facet[i] = cell.vertices[static_cast<unsigned>(kFacetVertices[k][i])];
        std::sort(facet.begin(), facet.end());
        facets[facet] = {own, across};
      }
    });
    return facets;
  }
  /// Every cell with its label and points.
  std::vector<std::array<double, 13>> content() const {
    std::vector<std::array<double, 13>> cells;
    for_each_cell([&](CellId c) {
      const auto [a, b, p, d] = points_of(*mesh_, c);
      cells.push_back({a.x, a.y, a.z, b.x, b.y, b.z, p.x, p.y, p.z, d.x, d.y, d.z, double(mesh_->label(c))});
    });
    return cells;
  }

 private:
  Isosurface isosurface_;
  OptimizerParameters parameters_;
  std::unique_ptr<Mesh> mesh_;
};

}  // namespace podm::test
