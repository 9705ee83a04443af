// NIfTI-1, read field by field in the layout of its header file nifti1.h: 348 bytes, then voxels. No library
// is used. The mesher's library would pass on its mistakes. ITK's reader refuses shear or silently takes the
// qform instead, aborts on an affine that is not finite, and fills missing voxels with zeros.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "image/byte_source.h"
#include "image/raw_image.h"

namespace podm::verify {

namespace {

constexpr std::int32_t kHeaderBytes = 348, kNifti2HeaderBytes = 540;

// Offsets of fields. Fields that are not listed do not affect voxels or their places.
enum Field : std::size_t {
  kSizeOfHeader = 0,
  kDim = 40,
  kDatatype = 70,
  kPixdim = 76,
  kVoxOffset = 108,
  kSclSlope = 112,
  kSclInter = 116,
  kXyztUnits = 123,
  kQformCode = 252,
  kSformCode = 254,
  kQuaternB = 256,
  kQoffsetX = 268,
  kSrowX = 280,
  kMagic = 344
};

class NiftiHeader {
 public:
  NiftiHeader(const std::string& path, ByteSource& source) {
    source.read(bytes_.data(), bytes_.size());
    std::int32_t size = at<std::int32_t>(kSizeOfHeader);
    is_swapped_ = size != kHeaderBytes && size != kNifti2HeaderBytes;
    size = at<std::int32_t>(kSizeOfHeader);
    if (size == kNifti2HeaderBytes) refuse(path, "NIfTI-2 is not supported (NIfTI-1 is)");
    if (size != kHeaderBytes || std::memcmp(bytes_.data() + kMagic, "n+1", 4) != 0)
      refuse(path, "not a NIfTI-1 file (wrong magic)");
  }
  bool is_swapped() const { return is_swapped_; }

  // Returns the n-th number of a field.
  template <class Number>
  Number at(Field field, std::size_t n = 0) const {
    std::array<unsigned char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), bytes_.data() + field + n * sizeof(Number), sizeof(Number));
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<Number>(bytes);
  }

 private:
  std::array<unsigned char, kHeaderBytes> bytes_{};
  bool is_swapped_ = false;
};

std::vector<std::int64_t> size_of(const std::string& path, const NiftiHeader& header) {
  const int num_axes = header.at<std::int16_t>(kDim);
  if (num_axes < 1 || num_axes > 7)
    refuse(path, "not a NIfTI-1 file (" + std::to_string(num_axes) + " dimensions)");
  std::vector<std::int64_t> size;
  for (int axis = 1; axis <= num_axes; ++axis)
    size.push_back(header.at<std::int16_t>(kDim, static_cast<std::size_t>(axis)));
  return size;
}

VoxelType voxel_type(const std::string& path, const NiftiHeader& header) {
  static const std::map<int, VoxelType> kTypes{{2, VoxelType::kUint8},    {4, VoxelType::kInt16},
                                               {8, VoxelType::kInt32},    {16, VoxelType::kFloat},
                                               {64, VoxelType::kDouble},  {256, VoxelType::kInt8},
                                               {512, VoxelType::kUint16}, {768, VoxelType::kUint32},
                                               {1024, VoxelType::kInt64}, {1280, VoxelType::kUint64}};
  const int datatype = header.at<std::int16_t>(kDatatype);
  const auto known = kTypes.find(datatype);
  if (known == kTypes.end())
    refuse(path, "one plain number per voxel is needed (NIfTI datatype " + std::to_string(datatype) + ")");
  return known->second;
}

// A header that names no unit means mm.
double unit_mm(const NiftiHeader& header) {
  constexpr int kSpatialBits = 7, kMetre = 1, kMicrometre = 3;
  const int unit = header.at<std::uint8_t>(kXyztUnits) & kSpatialBits;
  return unit == kMetre ? 1000 : unit == kMicrometre ? 0.001 : 1;
}

using Affine = std::array<double, 12>;

// Method 2 of nifti1.h: a rotation by the unit quaternion (a, b, c, d), a >= 0. The third axis is reversed if
// pixdim[0] is negative. If b^2 + c^2 + d^2 is 1 up to rounding, the rotation is half a turn.
Affine qform(const NiftiHeader& header) {
  constexpr double kHalfTurn = 1e-7;
  double b = header.at<float>(kQuaternB, 0), c = header.at<float>(kQuaternB, 1),
         d = header.at<float>(kQuaternB, 2);
  const double squared_a = 1 - (b * b + c * c + d * d);
  double a = 0;
  if (squared_a < kHalfTurn) {
    const double inverse_norm = 1 / std::sqrt(b * b + c * c + d * d);
    b *= inverse_norm;
    c *= inverse_norm;
    d *= inverse_norm;
  } else {
    a = std::sqrt(squared_a);
  }
  const std::array<double, 9> rotation{
      a * a + b * b - c * c - d * d, 2 * (b * c - a * d),           2 * (b * d + a * c),
      2 * (b * c + a * d),           a * a + c * c - b * b - d * d, 2 * (c * d - a * b),
      2 * (b * d - a * c),           2 * (c * d + a * b),           a * a + d * d - b * b - c * c};
  Affine affine{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool is_turned_over = axis == 2 && header.at<float>(kPixdim) < 0;
      const double voxel =
          static_cast<double>(header.at<float>(kPixdim, axis + 1)) * (is_turned_over ? -1 : 1);
      // A header is in single precision, and so is the sform that other programs write after reading this
      // qform.
      affine[4 * row + axis] = static_cast<float>(rotation[3 * row + axis] * voxel);
    }
    affine[4 * row + 3] = header.at<float>(kQoffsetX, row);
  }
  return affine;
}

// Returns the sform if there is one, otherwise the qform, otherwise the voxel sizes alone.
Affine voxel_to_world(const std::string& path, const NiftiHeader& header) {
  Affine affine{};
  if (header.at<std::int16_t>(kSformCode) > 0) {
    for (std::size_t i = 0; i < affine.size(); ++i) affine[i] = header.at<float>(kSrowX, i);
    return affine;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double voxel = header.at<float>(kPixdim, axis + 1);
    if (!(voxel > 0)) refuse(path, "the voxel spacing is not positive");
    affine[5 * axis] = voxel;
  }
  return header.at<std::int16_t>(kQformCode) > 0 ? qform(header) : affine;
}

// Returns the bytes between the header and the voxels. An offset below the smallest allowed one counts as
// that.
std::uint64_t gap_after(const std::string& path, const NiftiHeader& header) {
  constexpr float kSmallest = 352, kLargest = 1 << 24;  // kLargest is exact in a float
  const float offset = header.at<float>(kVoxOffset);
  if (!(offset <= kLargest)) refuse(path, "the NIfTI header is damaged (vox_offset)");
  return static_cast<std::uint64_t>(std::max(offset, kSmallest)) - kHeaderBytes;
}

}  // namespace

RawImage read_nifti(const std::string& path) {
  ByteSource source(path, path, 0, Compression::kIfGzipped);
  const NiftiHeader header(path, source);
  RawImage raw;
  raw.is_swapped = header.is_swapped();
  const std::vector<std::int64_t> size = size_of(path, header);
  raw.size.assign(size.begin(), size.end());
  raw.type = voxel_type(path, header);
  const float slope = header.at<float>(kSclSlope), inter = header.at<float>(kSclInter);
  if (slope != 0) {  // 0: voxels are not scaled
    raw.slope = slope;
    raw.intercept = inter;
  }
  raw.voxel_to_ras = voxel_to_world(path, header);
  for (double& entry : raw.voxel_to_ras) entry *= unit_mm(header);
  source.skip(gap_after(path, header));
  read_voxels(path, raw, source);
  return raw;
}

}  // namespace podm::verify
