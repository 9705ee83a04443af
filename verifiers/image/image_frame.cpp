#include "image/image_frame.h"

#include <array>
#include <cmath>

namespace podm::verify {

namespace {

using ExactMatrix = std::array<mpq_class, 12>;  // row-major 3x4

ExactMatrix exact(const std::array<double, 12>& a) {
  ExactMatrix m;
  for (std::size_t i = 0; i < 12; ++i) m[i] = a[i];
  return m;
}

// Inverts by cofactors. The matrix is not singular: the image's reader refuses a singular one.
ExactMatrix inverse(const ExactMatrix& a) {
  const auto cofactor = [&](std::size_t i, std::size_t j) -> mpq_class {
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return a[4 * i1 + j1] * a[4 * i2 + j2] - a[4 * i1 + j2] * a[4 * i2 + j1];
  };
  const mpq_class determinant = a[0] * cofactor(0, 0) + a[1] * cofactor(0, 1) + a[2] * cofactor(0, 2);
  ExactMatrix m;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m[4 * i + j] = cofactor(j, i) / determinant;
    m[4 * i + 3] = -(m[4 * i] * a[3] + m[4 * i + 1] * a[7] + m[4 * i + 2] * a[11]);
  }
  return m;
}

ImageFrame::Matrix rounded(const ExactMatrix& exact_matrix) {
  ImageFrame::Matrix m;
  for (std::size_t i = 0; i < 12; ++i) {
    const double high = exact_matrix[i].get_d();
    const mpq_class low = exact_matrix[i] - mpq_class(high);
    m[i] = static_cast<long double>(high) + static_cast<long double>(low.get_d());
  }
  return m;
}

constexpr std::array<double, 12> kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// LPS differs from RAS by the signs of x and y.
ExactMatrix with_flipped_input(ExactMatrix m) {
  for (const std::size_t column : {0U, 1U})
    for (std::size_t row = 0; row < 3; ++row) m[4 * row + column] = -m[4 * row + column];
  return m;
}

ExactMatrix exact_mesh_to_world(const Image& image, Space space) {
  if (space == Space::kVoxel) return exact(image.voxel_to_ras);
  return space == Space::kLps ? with_flipped_input(exact(kIdentity)) : exact(kIdentity);
}

}  // namespace

std::array<mpq_class, 12> exact_mesh_to_voxels(const std::array<double, 12>& voxel_to_ras, Space space) {
  if (space == Space::kVoxel) return exact(kIdentity);
  const ExactMatrix from_ras = inverse(exact(voxel_to_ras));
  return space == Space::kLps ? with_flipped_input(from_ras) : from_ras;
}

ImageFrame::ImageFrame(const Image& image, Space space)
    : space_(space),
      mesh_to_voxels_(rounded(exact_mesh_to_voxels(image.voxel_to_ras, space))),
      mesh_to_world_(rounded(exact_mesh_to_world(image, space))),
      voxels_to_world_(rounded(exact(image.voxel_to_ras))),
      world_to_voxels_(rounded(exact_mesh_to_voxels(image.voxel_to_ras, Space::kRas))) {}

Point ImageFrame::voxels_to_mesh(const Point& u) const {
  if (space_ == Space::kVoxel) return u;
  const Point p = voxels_to_world(u);
  return space_ == Space::kLps ? Point{-p[0], -p[1], p[2]} : p;
}

Point ImageFrame::world_to_voxels_vector(const Point& d) const {
  Point q;
  for (std::size_t r = 0; r < 3; ++r)
    q[r] = static_cast<double>(world_to_voxels_[4 * r] * d[0] + world_to_voxels_[4 * r + 1] * d[1] +
                               world_to_voxels_[4 * r + 2] * d[2]);
  return q;
}

Point ImageFrame::gradient_in_world(const Point& g) const {
  Point q;
  for (std::size_t c = 0; c < 3; ++c)
    q[c] = static_cast<double>(world_to_voxels_[c] * g[0] + world_to_voxels_[4 + c] * g[1] +
                               world_to_voxels_[8 + c] * g[2]);
  return q;
}

double ImageFrame::voxel_volume_mm3() const {
  const Matrix& a = voxels_to_world_;
  return static_cast<double>(std::abs(a[0] * (a[5] * a[10] - a[6] * a[9]) -
                                      a[1] * (a[4] * a[10] - a[6] * a[8]) +
                                      a[2] * (a[4] * a[9] - a[5] * a[8])));
}

Point ImageFrame::voxel_movement(const Point& world_movement) const {
  Point q{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      q[r] += static_cast<double>(std::abs(world_to_voxels_[4 * r + c])) * world_movement[c];
  return q;
}

std::string describe(Space space) {
  constexpr std::array kWords{"RAS (assumed, the file does not say)", "RAS", "LPS", "voxel"};
  return kWords[static_cast<std::size_t>(space)];
}

}  // namespace podm::verify
