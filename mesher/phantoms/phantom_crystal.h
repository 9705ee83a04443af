// The crystal phantom's grains.
#pragma once

#include <vector>

#include "phantoms/phantom_shapes.h"

namespace podm {

inline constexpr Vector kCrystalHalfExtent{50, 50, 50};  ///< mm

/// Grains that fill a cube with kCrystalHalfExtent: a point belongs to the nearest of fixed sites. The cube
/// has no margin, so the grains go on beyond the image.
std::vector<Organ> crystal_grains();

}  // namespace podm
