#include "image/raw_image.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "geometry/affine.h"
#include "podm/errors.h"
#include "podm/label_image.h"

namespace podm {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;  // by rows

// A direction whose deviation from orthonormal is smaller differs from it only by the rounding of the file's
// header.
constexpr double kHeaderRounding = 1e-5;
constexpr double kSmallestDeterminant = 1e-6;  // of three unit axes
constexpr double kSmallestSpacing = 1e-30,
                 kLargestSpacing = 1e30;        // their fifth powers neither overflow nor underflow
constexpr std::size_t kMaxLayers = kMaxLabels;  // the bytes of all layers then fit 64 bits
constexpr double kFurthestVoxels = 0x1p33;      // up to here doubles resolve a millionth of a voxel

double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Matrix inverse_transposed(const Matrix& m) {
  const double d = determinant(m);
  Matrix result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      result[i][j] = (m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1]) / d;
    }
  return result;
}

// The largest entry of M^T M - I.
double deviation_from_orthonormal(const Matrix& m) {
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double product = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
      largest = std::max(largest, std::abs(product - (i == j ? 1 : 0)));
    }
  return largest;
}

// Newton's iteration for the polar factor. It converges quadratically, therefore three steps from 1e-5
// suffice.
Matrix nearest_orthonormal(Matrix m) {
  for (int step = 0; step < 3; ++step) {
    const Matrix other = inverse_transposed(m);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) m[i][j] = (m[i][j] + other[i][j]) / 2;
  }
  return m;
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  return with_voxel_type(type, [](auto voxel) { return sizeof voxel; });
}

VoxelArray array_of(const RawImage& raw) {
  const auto voxel = static_cast<std::ptrdiff_t>(bytes_of(raw.type));
  const std::ptrdiff_t row = voxel * raw.size[0], slice = row * raw.size[1];
  return {raw.bytes.data(), raw.type, raw.size, {voxel, row, slice}};
}

void swap_bytes(std::vector<unsigned char>& bytes, std::size_t width) {
  for (std::size_t i = 0; i + width <= bytes.size(); i += width) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(i + width));
  }
}

void refuse(const std::string& path, const std::string& fault) { throw InputError(path + ": " + fault); }

std::size_t checked_num_voxels(const std::string& path, const std::vector<int>& size) {
  std::string sizes;
  for (const int n : size) sizes += (sizes.empty() ? "" : " x ") + std::to_string(n);
  if (size.size() < 3) refuse(path, "a 3-D image is needed (" + sizes + " voxels)");
  std::size_t voxels = 1;
  for (std::size_t axis = 0; axis < size.size(); ++axis) {
    if (size[axis] < 1) refuse(path, "the image has no voxels (" + sizes + ")");
    if (axis >= 3 && size[axis] > 1) refuse(path, "a 3-D image is needed (" + sizes + " voxels)");
    const auto n = static_cast<std::size_t>(size[axis]);
    if (n > kMaxVoxels / voxels)
      refuse(path, "the image is too large (" + sizes + " voxels, at most " + std::to_string(kMaxVoxels) +
                       " in all are supported)");
    voxels *= n;
  }
  return voxels;
}

void refuse_voxel(const RawImage& raw, std::size_t voxel, const std::string& fault,
                  const std::string& what_it_is_not) {
  const auto nx = static_cast<std::size_t>(raw.size[0]), ny = static_cast<std::size_t>(raw.size[1]);
  refuse(raw.path, fault + ": voxel (" + std::to_string(voxel % nx) + ", " + std::to_string(voxel / nx % ny) +
                       ", " + std::to_string(voxel / nx / ny) + ") is not " + what_it_is_not);
}

void check_room(const std::string& path, std::uint64_t bytes, std::uint64_t most_bytes) {
  if (bytes <= most_bytes) return;
  const auto gib = [](std::uint64_t number) {
    std::ostringstream text;
    text << std::setprecision(3) << static_cast<double>(number) / (1 << 30) << " GiB";
    return text.str();
  };
  refuse(path, "its voxels take " + gib(bytes) + " during reading, and there is room for only " +
                   gib(most_bytes) + " below the memory limit");
}

std::size_t checked_num_bytes(const RawImage& raw, std::uint64_t most_bytes) {
  const std::size_t voxels = checked_num_voxels(raw.path, raw.size);
  if (raw.num_layers > kMaxLayers)
    refuse(raw.path, std::to_string(raw.num_layers) + " layers, at most " + std::to_string(kMaxLayers) +
                         " are supported");
  const std::size_t needed = voxels * raw.num_layers * bytes_of(raw.type);
  check_room(raw.path, needed + voxels * (raw.num_layers > 1 ? sizeof(std::uint32_t) : sizeof(LabelIndex)),
             most_bytes);
  return needed;
}

std::array<double, 3> checked_spacing(const std::string& path, std::array<double, 12>& voxel_to_ras) {
  for (const double entry : voxel_to_ras)
    if (!std::isfinite(entry)) refuse(path, "the affine is not finite");
  std::array<double, 3> spacing{};
  Matrix direction{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    spacing[axis] = std::hypot(voxel_to_ras[axis], voxel_to_ras[4 + axis], voxel_to_ras[8 + axis]);
    if (!(spacing[axis] > 0) || !std::isfinite(spacing[axis]))
      refuse(path, "the voxel spacing is not positive (axis " + std::to_string(axis) + ")");
    if (spacing[axis] < kSmallestSpacing || spacing[axis] > kLargestSpacing)
      refuse(path, "the voxel spacing is not between 1e-30 and 1e30 mm (axis " + std::to_string(axis) + ")");
    for (std::size_t row = 0; row < 3; ++row)
      direction[row][axis] = voxel_to_ras[4 * row + axis] / spacing[axis];
  }
  if (!(std::abs(determinant(direction)) > kSmallestDeterminant))
    refuse(path, "the affine is singular (its axes lie in a plane)");
  if (deviation_from_orthonormal(direction) >= kHeaderRounding) return spacing;
  direction = nearest_orthonormal(direction);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis)
      voxel_to_ras[4 * row + axis] = direction[row][axis] * spacing[axis];
  return spacing;
}

// The map from the world to voxels adds up one term per coordinate. Its rounding error is relative to the
// largest term.
void check_distance(const std::string& path, const std::vector<int>& size,
                    const std::array<double, 12>& voxel_to_ras) {
  std::array<double, 3> furthest{};
  for (std::size_t row = 0; row < 3; ++row) {
    furthest[row] = std::abs(voxel_to_ras[4 * row + 3]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      furthest[row] += std::abs(voxel_to_ras[4 * row + axis]) * size[axis];
  }
  const auto ras_to_voxel = inverse(voxel_to_ras);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double voxels = 0;
    for (std::size_t row = 0; row < 3; ++row)
      voxels += std::abs(ras_to_voxel[4 * axis + row]) * furthest[row];
    if (!(voxels <= kFurthestVoxels))
      refuse(path, "the image reaches further than 2^33 voxels from the origin (axis " +
                       std::to_string(axis) + "), where the resolution of doubles is too coarse");
  }
}

}  // namespace podm
