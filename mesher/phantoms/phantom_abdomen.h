// The abdomen phantom's organs.
#pragma once

#include <vector>

#include "phantoms/phantom_shapes.h"

namespace podm {

inline constexpr Vector kAbdomenHalfExtent{165, 112, 97};  ///< mm

/// Organs within kAbdomenHalfExtent of the origin, in RAS: x right, y anterior, z superior.
std::vector<Organ> abdomen_organs();

/// The body with its large organs, in one piece, and a membrane across it: a coronal sheet, 2.2 mm thick,
/// which is one voxel at size 160.
std::vector<Organ> membrane_organs();

}  // namespace podm
