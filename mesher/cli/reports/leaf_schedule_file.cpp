#include "cli/reports/leaf_schedule_file.h"

#include <nlohmann/json.hpp>

#include "cli/reports/json_text.h"
#include "files/atomic_file.h"
#include "image/working_frame.h"

namespace podm::cli {
namespace {

using Json = nlohmann::ordered_json;

// Returns the map from coordinates of the mesh file to those of the leaves' grid.
Affine mesh_to_grid(const MeshRun& run, const LeafSchedule& schedule) {
  const bool is_voxel = run.options.space == Space::kVoxel;
  Affine grid = is_voxel ? voxels_to_working(run.image) : inverse(working_to_world(run.image));
  if (run.options.space == Space::kLps)
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t axis = 0; axis < 2; ++axis) grid[4 * row + axis] *= -1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid[4 * axis + 3] -= schedule.origin_mm[axis];
    for (std::size_t c = 0; c < 4; ++c) grid[4 * axis + c] /= schedule.side_mm;
  }
  return grid;
}

}  // namespace

void write_schedule(const MeshRun& run, const std::string& path) {
  if (!run.report.schedule) return;  // the run ended before the leaves
  const LeafSchedule& schedule = *run.report.schedule;
  Json leaves = Json::array();
  for (const auto& leaf : schedule.leaves)
    leaves.push_back({leaf.corner[0], leaf.corner[1], leaf.corner[2], leaf.side});
  AtomicFile file(path);
  file.write(json_line({{"schema", "podm-schedule/1"},
                        {"algorithm", to_string(run.report.algorithm)},
                        {"mesh_to_grid", mesh_to_grid(run, schedule)},
                        {"leaves", leaves}}));
  for (const auto& activation : schedule.activations)
    file.write(json_line({{"leaf", activation.leaf},
                          {"node", activation.node},
                          {"begin_s", activation.begin_s},
                          {"end_s", activation.end_s},
                          {"operations", activation.operations},
                          {"deferred", activation.deferred},
                          {"touched_leaves", activation.touched_leaves}}));
  file.publish();
}

}  // namespace podm::cli
