// Locates a cell's circumcenter in the image, with a bound on its error.
//
// The circumcenter is computed in the image frame: voxel indices times spacing, mm. Without shear that frame
// is the world's up to a rigid motion, so it is the circumcenter of the world. With shear the mesher works in
// this frame.
//
// Error bound. Let v0..v3 be off by at most t per coordinate, a_i = v_i - v0, n_i the cross product of the
// other two, D = a1 . n1. The center q + v0 solves a_i . q = |a_i|^2 / 2. Let a_i be off by d_i,
// |d_i| <= s = 2 sqrt(3) t. The right side minus the changed left side at q is d_i . (a_i - q) + |d_i|^2 / 2,
// and |a_i - q| = R. Let k = sum |n_i| / |D|, where n_i / D are the columns of the inverse matrix. Then q
// moves by at most
//   k (R s + s^2 / 2) / (1 - k s)   while k s < 1.
// The evaluation of q = (|a1|^2 n1 + |a2|^2 n2 + |a3|^2 n3) / 2D in doubles adds errors. With e = 2^-52 and
// T = |a1||a2||a3|, D errs by 7 e T (each component of n_1 errs by 2 e |a2||a3|), each component of the
// numerator by 9 e T (|a1| + |a2| + |a3|), and the quotient therefore by
//   (8 e T sum|a_i| + 7 e T |q|) / (|D| - 7 e T) + e |q|.
#pragma once

#include <gmpxx.h>

#include <optional>
#include <vector>

#include "image/image_frame.h"
#include "mesh.h"

namespace podm::verify {

struct LocatedPoint {
  Point voxels{};
  double error = 0;  ///< bounds the sum of the coordinates' errors; infinite for a cell flat by rounding
};

class CircumcenterLocator {
 public:
  /// Collective. Coordinates are taken to be known to 8 units of rounding of the largest term that the affine
  /// adds up. A mesher that works in voxels rounds a coordinate five times on its way to the file.
  CircumcenterLocator(const Mesh& mesh, const Image& image, const ImageFrame& frame, int threads);

  LocatedPoint circumcenter(CellId cell) const;
  LocatedPoint centroid(CellId cell) const;
  /// Returns the vertices in mm in the image frame.
  const std::vector<Point>& points() const { return points_; }

 private:
  const Mesh& mesh_;
  std::vector<Point> points_;
  Point voxels_per_mm_{};
  double point_error_mm_ = 0;    // t
  double l1_voxels_per_mm_ = 0;  // bound on the sum of voxel coordinates of a vector of 1 mm
  double voxel_rounding_ = 0;    // of the sum with v0 and the conversion to voxels
};

/// Returns the label at the circumcenter of the coordinates in the file, by rational arithmetic; none if the
/// cell is flat.
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
