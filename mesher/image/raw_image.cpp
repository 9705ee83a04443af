#include "image/raw_image.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <type_traits>
#include <unordered_map>

#include "podm/errors.h"

namespace podm {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;  // by rows

// A direction closer to orthonormal than this differs from it by the rounding of the file's header only.
constexpr double kHeaderRounding = 1e-5;

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

// Newton's iteration for the polar factor; it converges quadratically, so three steps from 1e-5 suffice.
Matrix nearest_orthonormal(Matrix m) {
  for (int step = 0; step < 3; ++step) {
    const Matrix other = inverse_transposed(m);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) m[i][j] = (m[i][j] + other[i][j]) / 2;
  }
  return m;
}

void set_frame(LabelImage& image, const std::array<double, 12>& affine, const std::string& path) {
  image.voxel_to_ras = affine;
  for (const double entry : affine)
    if (!std::isfinite(entry)) throw InputError(path + ": the affine is not finite");
  Matrix direction{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    image.spacing[axis] = std::hypot(affine[axis], affine[4 + axis], affine[8 + axis]);
    if (!(image.spacing[axis] > 0) || !std::isfinite(image.spacing[axis]))
      throw InputError(path + ": the voxel spacing is not positive (axis " + std::to_string(axis) + ")");
    for (std::size_t row = 0; row < 3; ++row)
      direction[row][axis] = affine[4 * row + axis] / image.spacing[axis];
  }
  if (!(std::abs(determinant(direction)) > 1e-6))
    throw InputError(path + ": the affine is singular (two axes are parallel)");
  if (deviation_from_orthonormal(direction) >= kHeaderRounding) return;
  direction = nearest_orthonormal(direction);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis)
      image.voxel_to_ras[4 * row + axis] = direction[row][axis] * image.spacing[axis];
}

template <class T>
std::uint32_t checked_value(T value, const std::string& path) {
  constexpr auto kLargest = std::numeric_limits<std::uint32_t>::max();
  bool is_label = true;
  if constexpr (std::is_floating_point_v<T>)
    is_label = value >= 0 && static_cast<double>(value) <= kLargest && value == std::trunc(value);
  else if constexpr (std::is_signed_v<T>)
    is_label = value >= 0 && static_cast<std::uint64_t>(value) <= kLargest;
  else
    is_label = value <= kLargest;
  if (is_label) return static_cast<std::uint32_t>(value);
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", static_cast<double>(value));
  throw InputError(path + ": not a label image (the value " + text +
                   " is not an integer from 0 to 4294967295)");
}

// Gives each new value the next index. Small values are looked up in an array, the others in a hash table.
class ValueIndex {
 public:
  explicit ValueIndex(std::vector<Label>& labels) : labels_(labels), small_(kSmallValues, kUnseen) {}

  LabelIndex operator()(std::uint32_t value, const std::string& path) {
    std::uint32_t& index =
        value < kSmallValues ? small_[value] : large_.try_emplace(value, kUnseen).first->second;
    if (index == kUnseen) {
      if (labels_.size() == kMaxLabels)
        throw InputError(path + ": not a label image (more than " + std::to_string(kMaxLabels) +
                         " different values)");
      index = static_cast<std::uint32_t>(labels_.size());
      labels_.push_back({value, {}});
    }
    return static_cast<LabelIndex>(index);
  }

 private:
  static constexpr std::uint32_t kSmallValues = 1 << 16;
  static constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();

  std::vector<Label>& labels_;
  std::vector<std::uint32_t> small_;
  std::unordered_map<std::uint32_t, std::uint32_t> large_;
};

template <class T>
void index_values(const std::vector<T>& values, LabelImage& image, const std::string& path) {
  image.voxels.resize(values.size());
  if (values.empty()) return;
  ValueIndex index_of(image.labels);
  T value = values[0];  // equal voxels come in runs
  LabelIndex index = index_of(checked_value(value, path), path);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] != value) {
      value = values[i];
      index = index_of(checked_value(value, path), path);
    }
    image.voxels[i] = index;
  }
}

}  // namespace

std::uint64_t checked_image_bytes(const std::array<std::int64_t, 3>& size, std::size_t bytes_per_voxel,
                                  const std::string& path) {
  const std::string sizes =
      std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]) + " voxels";
  std::uint64_t bytes = bytes_per_voxel;
  for (const std::int64_t n : size) {
    if (n < 1) throw InputError(path + ": the image has no voxels (" + sizes + ")");
    if (n > std::numeric_limits<int>::max() ||
        static_cast<std::uint64_t>(n) > std::numeric_limits<std::int64_t>::max() / bytes)
      throw InputError(path + ": the image is too large (" + sizes + ")");
    bytes *= static_cast<std::uint64_t>(n);
  }
  return bytes;
}

LabelImage index_labels(RawImage&& raw, const std::string& path) {
  LabelImage image;
  image.size = raw.size;
  set_frame(image, raw.voxel_to_ras, path);
  std::visit([&](const auto& values) { index_values(values, image, path); }, raw.voxels);
  raw.voxels = {};
  return image;
}

}  // namespace podm
