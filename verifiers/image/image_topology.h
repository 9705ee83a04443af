// Components and Euler numbers of the labels of an image, for both pairs of connectivity.
//
// A digital object and its complement need different connectivities (Kong and Rosenfeld, "Digital topology:
// introduction and survey", 1989): 6 for the label with 26 for the rest, or 26 with 6.
//   6:  voxels are points, shared faces are edges, and squares of four and cubes of eight are filled:
//       V - E + F - C of that complex.
//   26: voxels are closed cubes: V - E + F - C of their union.
#pragma once

#include <cstdint>
#include <map>

#include "image/image.h"

namespace podm::verify {

struct Topology {
  std::uint64_t voxels = 0;
  std::uint64_t components_6 = 0, components_26 = 0;
  std::int64_t euler_6 = 0, euler_26 = 0;
};

struct ImageTopology {
  std::map<std::uint32_t, Topology> of_label;  ///< without the background
  Topology all;                                ///< of all voxels that are not background
};

ImageTopology find_topology(const Image& image, int threads);

}  // namespace podm::verify
