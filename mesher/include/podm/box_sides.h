// The six sides of an image's box, by number: i-, i+, j-, j+, k-, k+. They are the planes of the outermost
// voxels' outer faces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace podm {

inline constexpr std::size_t kNumSides = 6;
inline constexpr std::array<const char*, kNumSides> kSideNames{"i-", "i+", "j-", "j+", "k-", "k+"};

/// A set of sides, one bit per number. Empty: a point or a facet on none of them.
using SideMask = std::uint8_t;

}  // namespace podm
