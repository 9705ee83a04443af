// Maps the coordinates of a mesh file to an image.
#pragma once

#include <gmpxx.h>

#include <array>

#include "image/image.h"
#include "mesh.h"

namespace podm::verify {

/// Returns the exact map from the coordinates of a mesh in `space` to voxel indices, row-major 3x4. A mesh
/// that states no space is taken to be RAS.
std::array<mpq_class, 12> exact_mesh_to_voxels(const std::array<double, 12>& voxel_to_ras, Space space);

class ImageFrame {
 public:
  ImageFrame(const Image& image, Space space);

  /// Computes in extended precision. The matrix is rounded once, so each result errs by less than 2^-60 of
  /// the sum of its terms' magnitudes, plus half an ulp.
  Point to_voxels(const Point& p) const { return apply(mesh_to_voxels_, p); }
  /// Returns RAS coordinates in mm.
  Point to_world(const Point& p) const { return apply(mesh_to_world_, p); }
  Point voxels_to_world(const Point& u) const { return apply(voxels_to_world_, u); }
  Point voxels_to_mesh(const Point& u) const;
  Point world_to_voxels(const Point& p) const { return apply(world_to_voxels_, p); }
  /// Maps a vector, that is, without the offset.
  Point world_to_voxels_vector(const Point& d) const;
  /// Converts a gradient by voxel coordinates to the gradient by mm.
  Point gradient_in_world(const Point& g) const;

  double voxel_volume_mm3() const;
  /// Returns the largest movement of each voxel coordinate when the world coordinates move by at most the
  /// given amounts.
  Point voxel_movement(const Point& world_movement) const;

  using Matrix = std::array<long double, 12>;

 private:
  static Point apply(const Matrix& m, const Point& p) {
    Point q;
    for (std::size_t r = 0; r < 3; ++r)
      q[r] = static_cast<double>(m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3]);
    return q;
  }

  Space space_;
  Matrix mesh_to_voxels_, mesh_to_world_, voxels_to_world_, world_to_voxels_;
};

/// Returns "RAS", "LPS", "voxel" or "RAS (assumed, the file does not say)".
std::string describe(Space space);

}  // namespace podm::verify
