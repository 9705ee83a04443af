// Finds where labels are thinner than surfaces sampled at a distance delta can show.
//
// The depth of a voxel is the distance from its center to the box of the nearest voxel of another label. A
// plate of one voxel has a depth of half a voxel. A plate of n voxels has a depth of at least (n - 1) / 2
// voxels in its middle. Let rho = 0.7 max(delta, longest side of a voxel). A voxel is kept if it lies in a
// ball around a voxel of depth rho or more. The radius of the ball is that depth plus 0.4 of the shortest
// side. This is a morphological opening by balls, with slack for the steps of oblique surfaces. All other
// voxels are thin.
//
// Reason: R1 leaves samples delta apart. A part thinner than delta has no room for its own cells, or only in
// some places. The factor 0.7 is based on experiments. In meshes of 80 random images at six deltas, no
// component deeper than delta / 2 was lost, and pieces that were cut off had a thin voxel within one voxel
// for rho = 0.6 max(delta, side). Tests and scripts/check_plan look for components that are lost or cut and
// not reported.
#pragma once

#include <cstdint>
#include <vector>

#include "image/voxel.h"
#include "podm/choices.h"
#include "podm/label_image.h"

namespace podm {

/// The role of a thin part: all of its component; a bridge that joins two or more kept pieces of the
/// component; or a detail such as a fin, a tip or an edge.
enum class ThinKind { kWhole, kBridge, kDetail };
template <>
struct Names<ThinKind> {
  static constexpr std::array kAll{std::pair{ThinKind::kWhole, "whole"},
                                   std::pair{ThinKind::kBridge, "bridge"},
                                   std::pair{ThinKind::kDetail, "detail"}};
};

/// Thin voxels of one label that are joined by faces.
struct ThinPart {
  LabelIndex label;
  ThinKind kind;
  Voxel deepest;            ///< the first of its deepest voxels
  double thickness_mm = 0;  ///< twice the depth there; up to a voxel less than the distance of the interfaces
  std::uint64_t num_voxels = 0;
};

/// All thin parts: whole components first, then bridges, then details, each sorted by volume, the largest
/// first. Takes 8 bytes per voxel. `threads`: 0 for all cores.
std::vector<ThinPart> find_thin_parts(const LabelImage& image, double delta_mm, int threads);

}  // namespace podm
