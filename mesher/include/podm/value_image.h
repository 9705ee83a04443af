// A volume of real values, on a grid of its own.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace podm {

struct ValueImage {
  std::string path;                       ///< for messages
  std::array<int, 3> size{};              ///< voxels per axis
  std::array<double, 12> voxel_to_ras{};  ///< row-major 3x4, voxel indices to world mm
  /// x fastest, finite; of single precision if that holds all values exactly.
  std::variant<std::vector<float>, std::vector<double>> values;
  std::vector<std::string> warnings = {};  ///< unusual properties of the file
};

}  // namespace podm
