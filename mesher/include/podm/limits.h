// The limits that end a run early.
#pragma once

#include <cstdint>

#include "podm/option.h"

namespace podm {

/// Largest number of cells of a mesh during the run, including background cells: facets have 32-bit numbers.
inline constexpr std::uint64_t kMostStoredCells = (std::uint64_t{1} << 30) - 1;

/// Each limit ends a run early with a valid mesh, which is Delaunay unless it was being optimised. The report
/// lists the guarantees that the mesh misses. 0: no limit.
struct Limits {
  std::uint64_t max_elements = 0;
  double max_seconds = 0;
  std::uint64_t max_memory_bytes = 0;  ///< does not include the image and the transform

  static constexpr auto options() {
    using L = Limits;
    using enum OptionGroup;
    return std::tuple{
        option(&L::max_elements, "max-elements", "N", kLimits, "stop at this number of cells",
               {.unset = "none", .uses = kInPodm | kOnRanks | kInPython}),
        option(&L::max_seconds, "max-seconds", "S", kLimits, "stop meshing after this number of seconds",
               {.unset = "none", .uses = kInPodm | kOnRanks | kInPython, .quantity = "number of seconds"})};
  }
};

}  // namespace podm
