#include "algorithms/mend_topology.h"

#include <algorithm>
#include <new>

#include "algorithms/podm.h"
#include "sizing/thin_layers.h"
#include "topology/labels_at_places.h"
#include "topology/places_to_mend.h"

namespace podm {

namespace {

constexpr const char* kMend = "mend";

// Labels the cells that no rule has asked about.
void label_unasked(Mesh& mesh, const Isosurface& isosurface) {
  for (CellId c = 0; c < mesh.cell_bound(); ++c)
    if (mesh.cell(c).is_alive() && mesh.label(c) == kUnknownLabel)
      mesh.label(c) = isosurface.label_at(mesh.cell(c).center);
}

// The topologies of a mesh and of its image, and what differs.
class Comparison {
 public:
  Comparison(const Mesh& mesh, const LabelImage& image)
      : mesh_(mesh),
        image_(image),
        of_mesh_(mesh, inverse(voxels_to_working(image))),
        of_image_(image, LabelsAtPlaces(mesh, image)),
        differences_(compare_topology(mesh, of_mesh_, image, of_image_)) {}

  std::vector<PlacesToMend> places() const {
    return places_to_mend(differences_, mesh_, of_mesh_, image_, of_image_);
  }

  void report_to(TopologyReport& report, const std::vector<PlacesToMend>& places) const {
    report.components = of_image_.size();
    report.ambiguous_places = of_image_.ambiguous_places().size();
    report.ambiguous = differences_.size() - places.size();
    report.differences.clear();
    for (const auto& [number, voxels] : places)
      report.differences.push_back(reported(differences_[number], voxels[voxels.size() / 2]));
  }

 private:
  TopologyReport::Difference reported(const RegionDifference& difference, std::size_t voxel) const {
    TopologyReport::Difference reported;
    reported.kind = difference.kind;
    const auto nx = static_cast<std::size_t>(image_.size[0]), ny = static_cast<std::size_t>(image_.size[1]);
    reported.voxel = {static_cast<int>(voxel % nx), static_cast<int>(voxel / nx % ny),
                      static_cast<int>(voxel / nx / ny)};
    const Point p = map(image_.voxel_to_ras,
                        Point{static_cast<double>(reported.voxel[0]), static_cast<double>(reported.voxel[1]),
                              static_cast<double>(reported.voxel[2])});
    reported.ras_mm = {p.x, p.y, p.z};
    reported.low = reported.high = reported.voxel;
    LabelIndex label = kBackground;
    if (difference.image_region != ImageRegions::kNone) {
      const ImageRegion& region = of_image_[difference.image_region];
      label = region.label;
      reported.low = {region.low.i, region.low.j, region.low.k};
      reported.high = {region.high.i, region.high.j, region.high.k};
      reported.of_image = {1, region.handles, region.cavities};
    }
    for (const std::uint32_t of_mesh : difference.mesh_regions) {
      const MeshRegion& region = of_mesh_[of_mesh];
      label = region.label;
      ++reported.of_mesh[0];
      reported.of_mesh[1] += region.handles;
      reported.of_mesh[2] += region.cavities;
    }
    reported.label = image_.labels[label];
    return reported;
  }

  const Mesh& mesh_;
  const LabelImage& image_;
  MeshRegions of_mesh_;
  ImageRegions of_image_;
  std::vector<RegionDifference> differences_;
};

// Calls visit(voxel number) for a voxel and those that it touches.
template <class Visit>
void for_each_around(const LabelImage& image, std::size_t voxel, const Visit& visit) {
  const auto nx = static_cast<std::size_t>(image.size[0]), ny = static_cast<std::size_t>(image.size[1]);
  const std::array<int, 3> at{static_cast<int>(voxel % nx), static_cast<int>(voxel / nx % ny),
                              static_cast<int>(voxel / nx / ny)};
  for (int k = std::max(at[2] - 1, 0); k <= std::min(at[2] + 1, image.size[2] - 1); ++k)
    for (int j = std::max(at[1] - 1, 0); j <= std::min(at[1] + 1, image.size[1] - 1); ++j)
      for (int i = std::max(at[0] - 1, 0); i <= std::min(at[0] + 1, image.size[0] - 1); ++i)
        visit(image.index(i, j, k));
}

// Halves the deltas at these places. Returns false if all are the least.
bool lower(const LabelImage& image, const std::vector<PlacesToMend>& places, DeltasAtVoxels& deltas) {
  std::vector<std::pair<std::size_t, double>> lowered;
  for (const auto& [number, voxels] : places)
    for (const std::size_t voxel : voxels)
      for_each_around(image, voxel, [&](std::size_t at) { lowered.emplace_back(at, deltas.at(at) / 2); });
  bool is_any = false;
  for (const auto& [voxel, delta_mm] : lowered) is_any = deltas.lower(voxel, delta_mm) || is_any;
  return is_any;
}

}  // namespace

void mend_topology(Construction& construction, Parameters& parameters) try {
  const Problem& problem = construction.problem();
  if (problem.thin == nullptr || construction.stop().is_over()) return;
  const LabelImage& image = problem.isosurface.image();
  DeltasAtVoxels deltas = problem.thin->deltas;
  TopologyReport report;
  report.least_delta_mm = deltas.least_mm();
  report.thin_voxels = problem.thin->num_voxels;
  for (bool is_finer = true; is_finer && !construction.stop().is_over();) {
    is_finer = false;
    construction.timed(kMend, [&] {
      label_unasked(construction.mesh(), problem.isosurface);
      const Comparison comparison(construction.mesh(), image);
      const std::vector<PlacesToMend> places = comparison.places();
      comparison.report_to(report, places);
      if (report.passes == 0) report.differences_at_first = report.differences.size();
      is_finer = lower(image, places, deltas);
      if (is_finer) parameters.deltas = deltas.graded();
    });
    if (!is_finer) break;
    ++report.passes;
    refine_anywhere(construction, kMend, parameters, construction.all_cells(), construction.num_workers());
  }
  construction.report(report);
} catch (const std::bad_alloc&) {  // for lists and maps; the mesh is whole
  construction.stop().end(StopReason::kMemoryLimit);
}

void compare_again(const Mesh& mesh, const LabelImage& image, TopologyReport& report) {
  const Comparison comparison(mesh, image);
  comparison.report_to(report, comparison.places());
}

}  // namespace podm
