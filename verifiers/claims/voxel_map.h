// The map from mesh coordinates to an image's voxel indices, over any field that exact.h computes in.
#pragma once

#include <array>

#include "geometry/exact.h"
#include "image/image_frame.h"

namespace podm::verify {

class VoxelMap {
 public:
  VoxelMap(const std::array<double, 12>& voxel_to_ras, Space space)
      : matrix_(constants(exact_mesh_to_voxels(voxel_to_ras, space))) {}

  template <class T>
  Vector<T> operator()(const Vector<T>& point) const {
    Vector<T> voxel;
    for (std::size_t row = 0; row < 3; ++row) {
      voxel[row] = matrix_[4 * row + 3].template in<T>();
      for (std::size_t i = 0; i < 3; ++i)
        voxel[row] = voxel[row] + matrix_[4 * row + i].template in<T>() * point[i];
    }
    return voxel;
  }

 private:
  static std::array<Constant, 12> constants(const std::array<mpq_class, 12>& m) {
    const auto at = [&](std::size_t i) { return Constant(Rational(m[i].get_mpq_t())); };
    return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9), at(10), at(11)};
  }

  std::array<Constant, 12> matrix_;
};

}  // namespace podm::verify
