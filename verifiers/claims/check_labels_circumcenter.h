// Where a cell's circumcentre lies in the image, and by how much that may be wrong.
//
// The circumcentre is taken in the image frame: voxel indices times spacing, mm. Without shear that frame is
// the world's up to a rigid motion, so it is the circumcentre of the world; with shear the mesher works here.
//
// Error bound. Let v0..v3 be off by at most t per coordinate, a_i = v_i - v0, n_i the cross product of the
// other two, D = a1 . n1. The centre q + v0 solves a_i . q = |a_i|^2 / 2. With a_i off by d_i, |d_i| <= s =
// 2 sqrt(3) t, the right side minus the changed left side at q is d_i . (a_i - q) + |d_i|^2 / 2, and
// |a_i - q| = R. So with k = sum |n_i| / |D|, the columns of the inverse matrix, q moves by at most
//   k (R s + s^2 / 2) / (1 - k s)   while k s < 1.
// Evaluating q = (|a1|^2 n1 + |a2|^2 n2 + |a3|^2 n3) / 2D in doubles adds, with e = 2^-52, T = |a1||a2||a3|:
//   7 e T for D (each component of n_1 errs by 2 e |a2||a3|), 9 e T (|a1| + |a2| + |a3|) for each component
//   of the numerator; the quotient then by (8 e T sum|a_i| + 7 e T |q|) / (|D| - 7 e T) + e |q|.
#pragma once

#include <gmpxx.h>

#include <optional>
#include <vector>

#include "image/image_frame.h"
#include "mesh.h"

namespace podm::verify {

struct LocatedPoint {
  Point voxels{};
  double error = 0;  ///< of the sum of the coordinates' errors; infinite for a cell that is flat by rounding
};

class CircumcenterLocator {
 public:
  /// Coordinates count as known to 8 units of rounding of the largest term that the affine adds up: who
  /// meshes in voxels rounds a point five times on its way to the file.
  CircumcenterLocator(const Mesh& mesh, const Image& image, const ImageFrame& frame, int threads);

  LocatedPoint circumcenter(CellId cell) const;
  LocatedPoint centroid(CellId cell) const;
  /// mm in the image frame.
  const std::vector<Point>& points() const { return points_; }

 private:
  const Mesh& mesh_;
  std::vector<Point> points_;
  Point voxels_a_mm_{};
  double point_error_mm_ = 0;  // t
  double l1_voxels_a_mm_ = 0;  // a vector of 1 mm has at most this sum of voxel coordinates
  double voxel_rounding_ = 0;  // of adding v0 and going to voxels
};

/// The label at the circumcentre of the coordinates as the file has them, by rational arithmetic; none where
/// the cell is flat.
class ExactCircumcenterLabel {
 public:
  ExactCircumcenterLabel(const Mesh& mesh, const Image& image, Space space);
  std::optional<std::uint32_t> operator()(CellId cell) const;

 private:
  const Mesh& mesh_;
  const Image& image_;
  std::array<mpq_class, 12> mesh_to_voxels_;
};

}  // namespace podm::verify
