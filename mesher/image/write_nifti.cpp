// NIfTI-1 label images.
#include <nifti/nifti1.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

constexpr std::size_t kDataOffset = 352;

bool ends_with(const std::string& path, const std::string& ending) {
  return path.size() >= ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

nifti_1_header header_of(const LabelImage& image, int bytes) {
  nifti_1_header h{};
  h.sizeof_hdr = 348;
  h.dim[0] = 3;
  for (int axis = 0; axis < 3; ++axis)
    h.dim[axis + 1] = static_cast<short>(image.size[static_cast<std::size_t>(axis)]);
  for (int axis = 4; axis < 8; ++axis) h.dim[axis] = 1;
  h.datatype = static_cast<short>(bytes == 1 ? DT_UINT8 : bytes == 2 ? DT_UINT16 : DT_UINT32);
  h.bitpix = static_cast<short>(8 * bytes);
  h.pixdim[0] = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) h.pixdim[axis + 1] = static_cast<float>(image.spacing[axis]);
  h.vox_offset = kDataOffset;
  h.scl_slope = 1;
  h.xyzt_units = NIFTI_UNITS_MM;
  h.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  for (std::size_t column = 0; column < 4; ++column) {
    h.srow_x[column] = static_cast<float>(image.voxel_to_ras[column]);
    h.srow_y[column] = static_cast<float>(image.voxel_to_ras[4 + column]);
    h.srow_z[column] = static_cast<float>(image.voxel_to_ras[8 + column]);
  }
  std::memcpy(h.magic, "n+1", 4);
  return h;
}

int bytes_a_voxel(const LabelImage& image) {
  std::uint32_t largest = 0;
  for (const Label& label : image.labels) largest = std::max(largest, label.value);
  return largest < 256 ? 1 : largest < 65536 ? 2 : 4;
}

bool write_all(gzFile file, const LabelImage& image) {
  const int bytes = bytes_a_voxel(image);
  const nifti_1_header header = header_of(image, bytes);
  const std::array<char, kDataOffset - sizeof(header)> extension{};
  if (gzwrite(file, &header, sizeof(header)) != static_cast<int>(sizeof(header))) return false;
  if (gzwrite(file, extension.data(), extension.size()) != static_cast<int>(extension.size())) return false;
  std::vector<unsigned char> row(static_cast<std::size_t>(image.size[0]) * static_cast<std::size_t>(bytes));
  for (std::size_t begin = 0; begin < image.voxels.size(); begin += static_cast<std::size_t>(image.size[0])) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(image.size[0]); ++i) {
      const std::uint32_t value = image.labels[image.voxels[begin + i]].value;
      std::memcpy(row.data() + i * static_cast<std::size_t>(bytes), &value, static_cast<std::size_t>(bytes));
    }
    if (gzwrite(file, row.data(), static_cast<unsigned>(row.size())) != static_cast<int>(row.size()))
      return false;
  }
  return true;
}

}  // namespace

void write_nifti(const LabelImage& image, const std::string& path) {
  const bool is_compressed = ends_with(path, ".nii.gz");
  if (!is_compressed && !ends_with(path, ".nii"))
    throw InputError(path + ": a NIfTI image ends in .nii or .nii.gz");
  for (const int size : image.size) {
    if (size > 32767) throw InputError(path + ": NIfTI-1 holds at most 32767 voxels along an axis");
  }
  const std::string aside = path + ".tmp" + std::to_string(getpid());
  const gzFile file = gzopen(aside.c_str(), is_compressed ? "wb6" : "wbT");
  if (file == nullptr) throw InputError(path + ": cannot be written");
  const bool is_written = write_all(file, image);
  const bool is_closed = gzclose(file) == Z_OK;
  std::error_code error;
  if (is_written && is_closed) std::filesystem::rename(aside, path, error);
  if (!is_written || !is_closed || error) {
    std::filesystem::remove(aside, error);
    throw InputError(path + ": writing failed (disk full?)");
  }
}

}  // namespace podm
