// A volume of the sizes that cells are to have, on a grid of its own.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace podm {

/// Bounds on the circumradius, mm. Between the centres of voxels the bound is trilinear: the mean of those of
/// the eight voxels around a point that have one, by their weights. The voxels at the border reach half a
/// voxel beyond their centres, as voxels do; elsewhere, and where none of the eight has a bound, there is
/// none.
struct SizeImage {
  std::string path;                        ///< for messages
  std::array<int, 3> size{};               ///< voxels per axis
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, voxel indices to world mm
  std::vector<float> radius_mm;            ///< x fastest; 0: the voxel has no bound
  std::vector<std::string> warnings = {};  ///< what is odd about the file

  std::size_t num_voxels() const { return radius_mm.size(); }
};

}  // namespace podm
