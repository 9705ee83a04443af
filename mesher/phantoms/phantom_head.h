// The head phantom's tissues.
#pragma once

#include <vector>

#include "phantoms/phantom_shapes.h"

namespace podm {

inline constexpr Vector kHeadHalfExtent{76, 95, 84};  ///< mm

/// Tissues within kHeadHalfExtent of the origin, in RAS. The fluid between skull and brain is 2.5 mm thick
/// over the gyri, and fills the sulci.
std::vector<Organ> head_organs();

}  // namespace podm
