// The differences between the topologies of a mesh and of its image, and how a run mended them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "podm/label_image.h"

namespace podm {

/// The ways in which a component of a label differs: it is not in the mesh; it is a part of another one; it
/// is only in the mesh; it is in pieces; or it has another number of handles, or of cavities
/// (topology/compare_topology.h).
enum class TopologyDifference { kLost, kJoined, kSpurious, kSplit, kHandles, kCavities };
template <>
struct Names<TopologyDifference> {
  static constexpr std::array kAll{std::pair{TopologyDifference::kLost, "lost"},
                                   std::pair{TopologyDifference::kJoined, "joined"},
                                   std::pair{TopologyDifference::kSpurious, "spurious"},
                                   std::pair{TopologyDifference::kSplit, "split"},
                                   std::pair{TopologyDifference::kHandles, "handles"},
                                   std::pair{TopologyDifference::kCavities, "cavities"}};
};

struct TopologyReport {
  struct Difference {
    TopologyDifference kind = TopologyDifference::kLost;
    Label label;
    std::array<int, 3> voxel{};        ///< a place of it
    std::array<double, 3> ras_mm{};    ///< the same
    std::array<int, 3> low{}, high{};  ///< bounds of the component, voxels
    /// Components, handles and cavities of the image's component and of the mesh's, if both are there.
    std::array<std::int64_t, 3> of_image{}, of_mesh{};
  };
  std::uint64_t components = 0;        ///< of all labels in the image
  std::uint64_t ambiguous_places = 0;  ///< of the image
  std::uint64_t ambiguous = 0;         ///< differences that ambiguous places explain, which count as none
  std::vector<Difference> differences;
  std::uint64_t differences_at_first = 0;  ///< before the first mending
  int passes = 0;                          ///< refinements after the first one, with smaller deltas
  double least_delta_mm = 0;               ///< no delta is smaller
  std::uint64_t thin_voxels = 0;           ///< of layers that were found to be thin
};

}  // namespace podm
