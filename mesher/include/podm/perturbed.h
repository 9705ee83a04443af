// What R7 did for dihedral angles (refine/perturbation.h): the best it could, which is counted.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "podm/choices.h"

namespace podm {

/// Why a cell keeps an angle out of bounds: what the point that came farthest met, of all to which one of its
/// vertices could have moved. kSpacing: other vertices were too near. kShape: a cell there would have had no
/// better angle, or too large a circumradius or radius-edge ratio. kSurface: one would have asked for a
/// vertex on the isosurface or beside it.
enum class Unmoved { kSpacing, kShape, kSurface };
template <>
struct Names<Unmoved> {
  static constexpr std::array kAll{std::pair{Unmoved::kSpacing, "spacing"},
                                   std::pair{Unmoved::kShape, "shape"},
                                   std::pair{Unmoved::kSurface, "surface"}};
};

struct Perturbed {
  double min_dihedral_deg = 0, max_dihedral_deg = 0;  ///< the bounds
  /// Cells with an angle out of bounds.
  struct Cells {
    std::uint64_t with_free_vertex = 0, without = 0;
    std::uint64_t number() const { return with_free_vertex + without; }
  };
  Cells before, after;
  std::array<std::uint64_t, Names<Unmoved>::kAll.size()> unmoved{};  ///< of those after, by reason
  std::uint64_t not_reached = 0;  ///< of those after, when the run ended early
};

}  // namespace podm
