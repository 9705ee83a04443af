// The lines of a run: how much of them the mesh has as edges, what was left out, and the shapes near them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "podm/label_image.h"

namespace podm {

struct LinesReport {
  bool is_traced = true;              ///< false: the run ended before the lines were traced
  double delta_mm = 0;                ///< lines were sampled at this distance
  double floor_mm = 0;                ///< shorter edges were not split
  std::uint64_t arcs = 0, nodes = 0;  ///< of the traced lines
  double traced_mm = 0, kept_mm = 0;  ///< length of the lines, and of their part that is edges of the mesh
  double excluded_mm = 0;   ///< length of their part that is too small, or too near another line, to be edges
  double untraced_mm = 0;   ///< what tracing contracts or removes, and an estimate of what it cannot decide
  std::uint64_t edges = 0;  ///< of the mesh, along lines
  std::uint64_t splits = 0;                       ///< of edges that made way for points
  std::uint64_t inexact_vertices = 0;             ///< vertices beside a line: the exact place was not found
  std::uint64_t cells_near = 0, facets_near = 0;  ///< with an end of a line's edge or a stray one
  std::optional<double> max_radius_edge_near, min_facet_angle_near_deg;  ///< of those, none if there are none
  std::optional<double> min_facet_angle_away_deg;                        ///< of all other facets

  /// A place where the resolution does not suffice to decide which labels meet.
  struct Undecided {
    std::string reason;
    std::array<int, 3> voxel{};
    std::array<double, 3> ras_mm{};
  };
  std::vector<Undecided> undecided;
  /// A stretch of a line that is not in the mesh.
  struct LeftOut {
    std::string reason;
    std::vector<Label> labels;
    double length_mm = 0;
    std::array<double, 3> ras_mm{};  ///< its middle
  };
  std::vector<LeftOut> left_out;

  /// Length of edges around which three or more labels meet in the mesh, and that are not kept as lines.
  /// Layers thinner than delta have such edges around their holes.
  double stray_mm = 0;
  /// True if the lines are traced, at most 0.05 % of them is missing or untraced, and at most 0.1 % of the
  /// edges where three labels meet are strays. The file then claims its lines. podm-verify allows 0.1 % of
  /// lines and edges. It counts points of the lines: along a diagonal a line has up to sqrt(3) times as many
  /// per length as along an axis.
  bool is_claimed() const {
    const double missing_mm = traced_mm - kept_mm;
    return is_traced && missing_mm + untraced_mm <= 0.5e-3 * traced_mm &&
           stray_mm <= 1e-3 * (kept_mm + stray_mm);
  }
  double share_kept() const { return traced_mm > 0 ? kept_mm / traced_mm : 1; }
};

}  // namespace podm
