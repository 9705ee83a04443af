// Where labels are thinner than surfaces sampled at a distance delta can show.
//
// A voxel's depth is the distance from its centre to the nearest voxel of another label, box by box; a plate
// of one voxel has half of it, and one of n voxels (n - 1) / 2 at least. Let rho = 0.7 max(delta, longest
// side of a voxel). A voxel is kept if it lies in a ball around one of depth rho or more whose radius is that
// depth and 0.4 of the shortest side: morphological opening by balls, and the steps of oblique surfaces
// allowed. The others are thin.
//
// Why: R1 leaves samples delta apart, so that what is thinner than delta has no room for cells of its own, or
// room here and there. 0.7 rests on experiments. In meshes of 80 random images at six deltas no component was
// lost whose depth is more than delta / 2, and pieces cut off have something thin within a voxel for rho =
// 0.6 max(delta, side). Tests and scripts/check_plan look for components lost or cut that are not told of.
#pragma once

#include <cstdint>
#include <vector>

#include "image/voxel.h"
#include "podm/choices.h"
#include "podm/label_image.h"

namespace podm {

/// What goes with a thin part: all of its component; what joins two or more of the component's parts that
/// stay; or a fin, a tip or an edge.
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
  Voxel deepest;            ///< the first of its deepest
  double thickness_mm = 0;  ///< twice the depth there: up to a voxel less than between the interfaces
  std::uint64_t num_voxels = 0;
};

/// All of them, those of whole components first, then bridges, each by volume, the largest first. Takes 8
/// bytes a voxel. `threads`: 0 for all cores.
std::vector<ThinPart> find_thin_parts(const LabelImage& image, double delta_mm, int threads);

}  // namespace podm
