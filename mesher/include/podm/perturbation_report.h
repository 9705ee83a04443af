// The result of R7 for dihedral angles (refine/perturbation.h). R7 improves angles as far as it can; it
// guarantees nothing.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "podm/choices.h"

namespace podm {

/// The reason why a cell keeps an angle out of bounds. One of its vertices could have moved to several
/// points; the reason belongs to the point that passed the most checks. kSpacing: other vertices were too
/// near. kShape: a cell there would have had no better angle, or too large a circumradius or radius-edge
/// ratio. kSurface: a cell would have required a vertex on the isosurface or beside it.
enum class Unmoved { kSpacing, kShape, kSurface };
template <>
struct Names<Unmoved> {
  static constexpr std::array kAll{std::pair{Unmoved::kSpacing, "spacing"},
                                   std::pair{Unmoved::kShape, "shape"},
                                   std::pair{Unmoved::kSurface, "surface"}};
};

struct PerturbationReport {
  double min_dihedral_deg = 0, max_dihedral_deg = 0;  ///< the bounds
  /// Numbers of cells with an angle out of bounds.
  struct Cells {
    std::uint64_t with_free_vertex = 0, without = 0;
    std::uint64_t number() const { return with_free_vertex + without; }
  };
  Cells before, after;
  std::array<std::uint64_t, Names<Unmoved>::kAll.size()> unmoved{};  ///< cells of `after`, by reason
  /// Cells of `after` that were not tried because the run ended early, or on ranks because their balls
  /// reached beyond what their rank knew.
  std::uint64_t not_reached = 0;
};

}  // namespace podm
