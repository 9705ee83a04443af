#include "podm/tet_mesh.h"

#include "podm/errors.h"

namespace podm {

std::string to_string(Space space) {
  switch (space) {
    case Space::kRas:
      return "RAS";
    case Space::kLps:
      return "LPS";
    case Space::kVoxel:
      return "voxel";
  }
  throw InternalError("unknown space");
}

}  // namespace podm
