// The abdomen phantom's organs.
#pragma once

#include <vector>

#include "image/phantom_shapes.h"

namespace podm {

/// About 330 x 225 x 195 mm around the origin, RAS: x right, y anterior, z superior.
std::vector<Organ> abdomen_organs();

}  // namespace podm
