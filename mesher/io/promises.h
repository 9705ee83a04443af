// The promises of a mesh in its file: for an optimised mesh, the claim of all other meshes that it does not
// keep; bounds on dihedral angles, if they were requested and reached; the width by which interfaces were
// smoothed; the distance at which lines were sampled, if the mesh has them; that facets lie in the planes of
// a flat box; and, if thin layers were kept, the topology of the image's labels, except for differences that
// it lists with kind, label and voxel. Other meshes have no such words.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

/// Returns texts such as "unclaimed delaunay", "dihedral 8 165" and "smoothed 1.5", "box flat", "lines 2.5",
/// "topology 1" and "differs split 3 10 20 30", in the words of podm-verify.
inline std::vector<std::string> promises_of(const TetMesh& mesh) {
  std::vector<std::string> promises;
  if (mesh.is_optimized) promises.emplace_back("unclaimed delaunay");
  if (mesh.dihedral_bounds_deg)
    promises.push_back(
        fmt::format("dihedral {} {}", (*mesh.dihedral_bounds_deg)[0], (*mesh.dihedral_bounds_deg)[1]));
  if (mesh.smoothing_mm > 0) promises.push_back(fmt::format("smoothed {}", mesh.smoothing_mm));
  if (mesh.is_box_flat) promises.emplace_back("box flat");
  if (mesh.lines.are_kept()) promises.push_back(fmt::format("lines {}", mesh.lines.delta_mm));
  if (mesh.lines.are_kept() && !mesh.lines.are_claimed) promises.emplace_back("unclaimed lines");
  if (!mesh.topology_differences) return promises;
  promises.push_back(fmt::format("topology {}", mesh.topology_differences->size()));
  for (const TopologyReport::Difference& each : *mesh.topology_differences)
    promises.push_back(
        fmt::format("differs {} {} {}", to_string(each.kind), each.label.value, fmt::join(each.voxel, " ")));
  return promises;
}

}  // namespace podm
