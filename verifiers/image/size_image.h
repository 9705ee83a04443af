// The volume of bounds on circumradii that a mesh was made with, read by the verifier's own code.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace podm::verify {

/// Voxels are stored x fastest.
struct SizeImage {
  std::string path;
  std::array<int, 3> size{};
  std::array<double, 12> voxel_to_ras{};  ///< row-major 3x4, voxel indices to world mm
  std::vector<float> radius_mm;           ///< 0: the voxel has no bound
  std::vector<std::string> warnings = {};
};

/// Reads the formats of read_image(), with any numbers as voxels, scaled by the header. A value that is not
/// above 0, or infinite in single precision, is no bound. Throws InputError, also if a voxel is not a number.
SizeImage read_size_image(const std::string& path);

}  // namespace podm::verify
