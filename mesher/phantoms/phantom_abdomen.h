// The abdomen phantom's organs.
#pragma once

#include <vector>

#include "phantoms/phantom_shapes.h"

namespace podm {

inline constexpr Vector kAbdomenHalfExtent{165, 112, 97};  ///< mm

/// Organs within kAbdomenHalfExtent of the origin, in RAS: x right, y anterior, z superior.
std::vector<Organ> abdomen_organs();

}  // namespace podm
