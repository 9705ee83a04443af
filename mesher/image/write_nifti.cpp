// Writes label images as NIfTI-1.
#include <nifti/nifti1_io.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "files/temporary_file.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

constexpr std::size_t kDataOffset = 352;
constexpr int kLongestAxis = std::numeric_limits<short>::max();

[[noreturn]] void fail(const std::string& path, const std::string& fault) {
  throw InputError(path + ": " + fault);
}

struct VoxelFormat {
  short datatype;
  std::size_t bytes;
};

// Prefers int32 to uint32 where it suffices, as more programs read it.
VoxelFormat smallest_format(const LabelImage& image) {
  std::uint32_t largest = 0;
  for (const Label& label : image.labels) largest = std::max(largest, label.value);
  if (largest <= std::numeric_limits<std::uint8_t>::max()) return {DT_UINT8, 1};
  if (largest <= std::numeric_limits<std::uint16_t>::max()) return {DT_UINT16, 2};
  if (largest <= std::numeric_limits<std::int32_t>::max()) return {DT_INT32, 4};
  return {DT_UINT32, 4};
}

// The quaternion form can only represent rotations and spacings: the columns must be orthogonal.
bool has_orthogonal_columns(const std::array<double, 12>& m) {
  constexpr double kLargestCosine = 1e-6;
  const auto product = [&](std::size_t a, std::size_t b) {
    return m[a] * m[b] + m[4 + a] * m[4 + b] + m[8 + a] * m[8 + b];
  };
  for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
    if (std::abs(product(a, b)) > kLargestCosine * std::sqrt(product(a, a) * product(b, b))) return false;
  }
  return true;
}

void set_affine(nifti_1_header& header, const LabelImage& image) {
  mat44 affine{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      affine.m[row][column] = static_cast<float>(image.voxel_to_ras[4 * row + column]);
    }
  }
  affine.m[3][3] = 1;
  std::memcpy(header.srow_x, affine.m[0], sizeof header.srow_x);
  std::memcpy(header.srow_y, affine.m[1], sizeof header.srow_y);
  std::memcpy(header.srow_z, affine.m[2], sizeof header.srow_z);
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.pixdim[0] = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.pixdim[axis + 1] = static_cast<float>(image.spacing[axis]);
  }
  if (!has_orthogonal_columns(image.voxel_to_ras)) return;
  header.qform_code = NIFTI_XFORM_SCANNER_ANAT;
  nifti_mat44_to_quatern(affine, &header.quatern_b, &header.quatern_c, &header.quatern_d, &header.qoffset_x,
                         &header.qoffset_y, &header.qoffset_z, nullptr, nullptr, nullptr, &header.pixdim[0]);
}

nifti_1_header header_of(const LabelImage& image, const VoxelFormat& format) {
  nifti_1_header header{};
  header.sizeof_hdr = sizeof header;
  header.dim[0] = 3;
  for (std::size_t axis = 0; axis < 3; ++axis) header.dim[axis + 1] = static_cast<short>(image.size[axis]);
  for (std::size_t axis = 4; axis < 8; ++axis) header.dim[axis] = 1;
  header.datatype = format.datatype;
  header.bitpix = static_cast<short>(8 * format.bytes);
  header.vox_offset = kDataOffset;
  header.scl_slope = 1;
  header.xyzt_units = NIFTI_UNITS_MM;
  set_affine(header, image);
  std::memcpy(header.magic, "n+1", sizeof header.magic);
  return header;
}

// A temporary file beside `path`, compressed or not.
class PendingFile {
 public:
  PendingFile(const std::string& path, bool is_compressed) : path_(path), file_(path) {
    // gzclose() closes the descriptor.
    stream_ = ::gzdopen(file_.new_descriptor(), is_compressed ? "wb6" : "wbT");
    if (stream_ == nullptr) fail_to_write(path_, errno);
  }
  ~PendingFile() {
    if (stream_ != nullptr) ::gzclose(stream_);
  }
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  void write(const void* bytes, std::size_t size) {
    errno = 0;
    if (::gzfwrite(bytes, 1, size, stream_) != size) fail_to_write(path_, errno != 0 ? errno : EIO);
  }

  void publish() {
    errno = 0;
    if (::gzclose(std::exchange(stream_, nullptr)) != Z_OK) fail_to_write(path_, errno != 0 ? errno : EIO);
    TemporaryFile::publish(std::array{&file_});
  }

 private:
  std::string path_;
  TemporaryFile file_;
  gzFile stream_ = nullptr;
};

void write_voxels(PendingFile& file, const LabelImage& image, std::size_t bytes) {
  const auto row_length = static_cast<std::size_t>(image.size[0]);
  std::vector<char> row(row_length * bytes);
  for (std::size_t begin = 0; begin < image.voxels.size(); begin += row_length) {
    for (std::size_t i = 0; i < row_length; ++i) {
      const std::uint32_t value = image.labels[image.voxels[begin + i]].value;
      std::memcpy(row.data() + i * bytes, &value, bytes);  // little-endian: the low bytes come first
    }
    file.write(row.data(), row.size());
  }
}

}  // namespace

void write_nifti(const LabelImage& image, const std::string& path) {
  const bool is_compressed = path.ends_with(".nii.gz");
  if (!is_compressed && !path.ends_with(".nii"))
    fail(path, "the name of a NIfTI image must end in .nii or .nii.gz");
  if (*std::max_element(image.size.begin(), image.size.end()) > kLongestAxis) {
    fail(path, "NIfTI-1 holds at most " + std::to_string(kLongestAxis) + " voxels along an axis");
  }
  const VoxelFormat format = smallest_format(image);
  const nifti_1_header header = header_of(image, format);
  const std::array<char, kDataOffset - sizeof header> no_extension{};
  PendingFile file(path, is_compressed);
  file.write(&header, sizeof header);
  file.write(no_extension.data(), no_extension.size());
  write_voxels(file, image, format.bytes);
  file.publish();
}

}  // namespace podm
