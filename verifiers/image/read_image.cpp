// Reads label values from a path: picks the reader of the format, converts voxels to labels, checks the
// affine.
#include <algorithm>
#include <cmath>

#include "image/image.h"
#include "image/label_selection.h"
#include "image/raw_image.h"
#include "image/segmentation.h"

namespace podm::verify {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;  // by rows

// Returns the label of voxel i.
template <class Voxel>
std::uint32_t label_value(const Image& image, std::size_t i, Voxel voxel) {
  constexpr double kEnd = 4294967296.0;
  const auto value = static_cast<double>(voxel);
  const auto x = static_cast<std::size_t>(image.size[0]), y = static_cast<std::size_t>(image.size[1]);
  if (!(value >= 0 && value < kEnd) || std::floor(value) != value)
    refuse(image.path, "a label image is needed: voxel (" + std::to_string(i % x) + ", " +
                           std::to_string(i / x % y) + ", " + std::to_string(i / x / y) + ") has the value " +
                           std::to_string(voxel) + ", which is not a label (integers, 0 to 2^32-1)");
  return static_cast<std::uint32_t>(value);
}

double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// Returns one step of Newton's iteration for the orthonormal matrix nearest to m: the mean of m and its
// inverse transposed. A distance e becomes one within e^2.
Matrix step_to_orthonormal(const Matrix& m) {
  const double d = determinant(m);
  Matrix mean{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      mean[i][j] = (m[i][j] + (m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1]) / d) / 2;
    }
  return mean;
}

double distance_to_orthonormal(const Matrix& m) {
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double product = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
      largest = std::max(largest, std::abs(product - (i == j ? 1 : 0)));
    }
  return largest;
}

}  // namespace

// Headers state directions in single precision or with six digits. A direction that is orthonormal up to this
// rounding is meant to be orthonormal, and the nearest orthonormal one replaces it: nothing else gives the
// places of voxels to 1e-7 of the image's width. A direction further from orthonormal is shear and is kept.
std::array<double, 3> orthogonalize_affine(const std::string& path, std::array<double, 12>& a) {
  constexpr double kHeaderRounding = 1e-5, kSmallestDeterminant = 1e-6;
  std::array<double, 3> spacing{};
  Matrix direction{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    spacing[axis] = std::hypot(a[axis], a[4 + axis], a[8 + axis]);
    if (!(spacing[axis] > 0) || !std::isfinite(spacing[axis]) || !std::isfinite(a[4 * axis + 3]))
      refuse(path, "the voxel spacing is not positive or the affine not finite (axis " +
                       std::to_string(axis) + ")");
    for (std::size_t row = 0; row < 3; ++row) direction[row][axis] = a[4 * row + axis] / spacing[axis];
  }
  if (!(std::abs(determinant(direction)) > kSmallestDeterminant))
    refuse(path, "the affine is singular (its axes lie in a plane)");
  if (distance_to_orthonormal(direction) >= kHeaderRounding) return spacing;
  for (int step = 0; step < 3; ++step) direction = step_to_orthonormal(direction);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis) a[4 * row + axis] = direction[row][axis] * spacing[axis];
  return spacing;
}

RawImage read_raw(const std::string& path) {
  const auto ends_in = [&](std::initializer_list<const char*> endings) {
    return std::any_of(endings.begin(), endings.end(), [&](const char* e) { return path.ends_with(e); });
  };
  if (ends_in({".nii", ".nii.gz"})) return read_nifti(path);
  if (ends_in({".nrrd", ".nhdr"})) return read_nrrd(path);
  if (ends_in({".mha", ".mhd"})) return read_meta(path);
  if (ends_in({".inr", ".inr.gz"})) return read_inr(path);
  refuse(path, "unknown image format (known: .nii .nii.gz .nrrd .nhdr .mha .mhd .inr .inr.gz)");
}

Image read_image(const std::string& path) { return read_image(path, {}); }

Image read_image(const std::string& path, const LabelSelection& selection) {
  RawImage raw = read_raw(path);
  check_layers(path, raw, selection);
  Image image;
  image.path = path;
  image.warnings = raw.warnings;
  for (std::size_t axis = 0; axis < 3; ++axis) image.size[axis] = static_cast<int>(raw.size[axis]);
  image.voxel_to_ras = raw.voxel_to_ras;
  image.spacing = orthogonalize_affine(path, image.voxel_to_ras);
  if (raw.slope != 1 || raw.intercept != 0)
    refuse(path, "a label image is needed (the header scales the voxels: scl_slope, scl_inter)");
  if (raw.num_layers > 1) {
    merge_layers(raw, selection, image);
    return image;
  }
  image.voxels.resize(raw.bytes.size() / bytes_of(raw.type));
  for_each_voxel(raw, [&](std::size_t i, auto voxel) { image.voxels[i] = label_value(image, i, voxel); });
  return image;
}

}  // namespace podm::verify
