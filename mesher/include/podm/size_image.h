// A volume of requested cell sizes, on a grid of its own.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace podm {

/// Bounds on the circumradius, mm. Between voxel centers the bound is trilinear: the weighted mean over those
/// of the eight surrounding voxels that have a bound. Border voxels reach half a voxel beyond their centers.
/// There is no bound elsewhere, nor where none of the eight voxels has one.
struct SizeImage {
  std::string path;                        ///< for messages
  std::array<int, 3> size{};               ///< voxels per axis
  std::array<double, 12> voxel_to_ras{};   ///< row-major 3x4, voxel indices to world mm
  std::vector<float> radius_mm;            ///< x fastest; 0: the voxel has no bound
  std::vector<std::string> warnings = {};  ///< unusual properties of the file

  std::size_t num_voxels() const { return radius_mm.size(); }
};

}  // namespace podm
