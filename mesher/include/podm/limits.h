// What ends a run early.
#pragma once

#include <cstdint>

#include "podm/option.h"

namespace podm {

/// The most cells of a mesh while it is made, those of the background among them: facets have numbers of 32
/// bits.
inline constexpr std::uint64_t kMostStoredCells = (std::uint64_t{1} << 30) - 1;

/// Each ends a run early, with a valid mesh, Delaunay unless it was being optimised, that says what is unmet.
/// 0: no limit.
struct Limits {
  std::uint64_t max_elements = 0;
  double max_seconds = 0;
  std::uint64_t max_memory_bytes = 0;  ///< image and transform come on top

  static constexpr auto options() {
    using L = Limits;
    using enum OptionGroup;
    return std::tuple{option(&L::max_elements, {.name = "max-elements",
                                                .type = "N",
                                                .group = kLimits,
                                                .help = "stop at this number of cells",
                                                .unset = "none",
                                                .uses = kInPodm | kOnRanks | kInPython}),
                      option(&L::max_seconds, {.name = "max-seconds",
                                               .type = "S",
                                               .group = kLimits,
                                               .help = "stop meshing after this number of seconds",
                                               .unset = "none",
                                               .uses = kInPodm | kOnRanks | kInPython,
                                               .quantity = "number of seconds"})};
  }
};

}  // namespace podm
