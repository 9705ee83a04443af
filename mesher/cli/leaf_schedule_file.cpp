#include "cli/leaf_schedule_file.h"

#include "cli/json_text.h"
#include "io/atomic_file.h"

namespace podm::cli {
namespace {

using Json = nlohmann::ordered_json;
using Affine = std::array<double, 12>;  // row-major 3x4

Affine inverse(const Affine& a) {
  const auto cofactor = [&](std::size_t r, std::size_t c) {
    const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return a[4 * r1 + c1] * a[4 * r2 + c2] - a[4 * r1 + c2] * a[4 * r2 + c1];
  };
  const double det = a[0] * cofactor(0, 0) + a[1] * cofactor(0, 1) + a[2] * cofactor(0, 2);
  Affine b{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) b[4 * r + c] = cofactor(c, r) / det;
    for (std::size_t c = 0; c < 3; ++c) b[4 * r + 3] -= b[4 * r + c] * a[4 * c + 3];
  }
  return b;
}

// From coordinates of the mesh file to those of the leaves' grid.
Affine mesh_to_grid(const MeshRun& run, const LeafSchedule& schedule) {
  Affine to_voxel{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  if (run.options.space != Space::kVoxel) {
    Affine voxel_to_mesh = run.image.voxel_to_ras;
    for (std::size_t i = 0; i < 8 && run.options.space == Space::kLps; ++i) voxel_to_mesh[i] *= -1;
    to_voxel = inverse(voxel_to_mesh);
  }
  Affine grid = to_voxel;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t c = 0; c < 4; ++c) grid[4 * axis + c] *= run.image.spacing[axis];
    grid[4 * axis + 3] -= schedule.origin_mm[axis];
    for (std::size_t c = 0; c < 4; ++c) grid[4 * axis + c] /= schedule.side_mm;
  }
  return grid;
}

}  // namespace

void write_schedule(const MeshRun& run, const std::string& path) {
  if (!run.result.report.schedule)
    throw InputError(path + ": no leaves were refined; use --algorithm pdr or pdr-podm");
  const LeafSchedule& schedule = *run.result.report.schedule;
  Json leaves = Json::array();
  for (const auto& leaf : schedule.leaves)
    leaves.push_back({leaf.corner[0], leaf.corner[1], leaf.corner[2], leaf.side});
  AtomicFile file(path);
  file.write(json_line({{"schema", "podm-schedule/1"},
                        {"algorithm", to_string(run.result.report.algorithm)},
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
