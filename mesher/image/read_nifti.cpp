// Reads NIfTI-1 with libnifti's header functions. ITK's reader is not used: it aborts on an affine that is
// not finite, refuses shear or silently falls back to the qform, and fills missing voxels with zeros.
#include <nifti/nifti1_io.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "image/input_file.h"
#include "image/read_formats.h"
#include "runtime/parallel_resize.h"

namespace podm {

namespace {

struct Header {
  nifti_1_header fields{};
  bool is_swapped = false;  // written on a machine of the other byte order
};

Header read_header(InputFile& file, const std::string& path) {
  Header header;
  file.read(&header.fields, sizeof header.fields);
  constexpr int kNifti2Bytes = 540;
  int bytes = header.fields.sizeof_hdr;
  if (bytes != sizeof header.fields && bytes != kNifti2Bytes) {
    nifti_swap_4bytes(1, &bytes);
    header.is_swapped = true;
  }
  if (bytes == kNifti2Bytes) refuse(path, "NIfTI-2 is not supported (NIfTI-1 is)");
  if (bytes != sizeof header.fields || std::memcmp(header.fields.magic, "n+1", 4) != 0)
    refuse(path, "not a NIfTI-1 file (wrong magic)");
  if (header.is_swapped) swap_nifti_header(&header.fields, NIFTI_VERSION(header.fields));
  return header;
}

VoxelType voxel_type(const std::string& path, int datatype) {
  switch (datatype) {
    case DT_UINT8:
      return VoxelType::kUint8;
    case DT_INT8:
      return VoxelType::kInt8;
    case DT_UINT16:
      return VoxelType::kUint16;
    case DT_INT16:
      return VoxelType::kInt16;
    case DT_UINT32:
      return VoxelType::kUint32;
    case DT_INT32:
      return VoxelType::kInt32;
    case DT_UINT64:
      return VoxelType::kUint64;
    case DT_INT64:
      return VoxelType::kInt64;
    case DT_FLOAT32:
      return VoxelType::kFloat;
    case DT_FLOAT64:
      return VoxelType::kDouble;
    default:
      refuse(path, "one real number per voxel is needed (NIfTI datatype " + std::to_string(datatype) + ")");
  }
}

std::vector<int> sizes(const nifti_1_header& header, const std::string& path) {
  if (header.dim[0] < 1 || header.dim[0] > 7)
    refuse(path, "not a NIfTI-1 file (" + std::to_string(header.dim[0]) + " dimensions)");
  return {header.dim + 1, header.dim + 1 + header.dim[0]};
}

// mm per unit of the header. The unit is mm if the header names none.
double unit_mm(const nifti_1_header& header) {
  switch (XYZT_TO_SPACE(header.xyzt_units)) {
    case NIFTI_UNITS_METER:
      return 1000;
    case NIFTI_UNITS_MICRON:
      return 0.001;
    default:
      return 1;
  }
}

mat44 affine(const nifti_1_header& h, const std::string& path) {
  mat44 a{};
  if (h.sform_code > 0) {
    std::memcpy(a.m[0], h.srow_x, sizeof h.srow_x);
    std::memcpy(a.m[1], h.srow_y, sizeof h.srow_y);
    std::memcpy(a.m[2], h.srow_z, sizeof h.srow_z);
    return a;
  }
  for (int axis = 1; axis <= 3; ++axis)
    if (!(h.pixdim[axis] > 0)) refuse(path, "the voxel spacing is not positive");
  if (h.qform_code > 0)
    return nifti_quatern_to_mat44(h.quatern_b, h.quatern_c, h.quatern_d, h.qoffset_x, h.qoffset_y,
                                  h.qoffset_z, h.pixdim[1], h.pixdim[2], h.pixdim[3],
                                  h.pixdim[0] < 0 ? -1.0F : 1.0F);
  for (int axis = 0; axis < 3; ++axis) a.m[axis][axis] = h.pixdim[axis + 1];
  return a;
}

// The position of the first voxel. An offset that is too small stands for the end of the header.
std::uint64_t voxel_offset(const nifti_1_header& header, const std::string& path) {
  constexpr float kSmallest = 352, kLargest = 1 << 24;  // exact in a float
  if (!(header.vox_offset <= kLargest)) refuse(path, "the NIfTI header is damaged (vox_offset)");
  return static_cast<std::uint64_t>(std::max(header.vox_offset, kSmallest));
}

RawImage image_of(const nifti_1_header& header, const std::string& path) {
  RawImage raw;
  raw.path = path;
  raw.size = sizes(header, path);
  raw.type = voxel_type(path, header.datatype);
  if (header.scl_slope != 0) {  // 0: voxels are not scaled
    raw.slope = header.scl_slope;
    raw.intercept = header.scl_inter;
  }
  const mat44 a = affine(header, path);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      raw.voxel_to_ras[4 * row + column] = unit_mm(header) * static_cast<double>(a.m[row][column]);
  return raw;
}

}  // namespace

ImageHead read_nifti_head(const std::string& path) {
  InputFile file(path);
  const auto [header, is_swapped] = read_header(file, path);
  static_assert(std::endian::native == std::endian::little);
  return {image_of(header, path), {path, voxel_offset(header, path), file.is_compressed(), is_swapped}};
}

RawImage read_nifti(const std::string& path, std::uint64_t most_bytes) {
  InputFile file(path);
  const auto [header, is_swapped] = read_header(file, path);
  RawImage raw = image_of(header, path);
  const std::size_t needed = checked_num_bytes(raw, most_bytes);
  file.expect_room_for(needed);
  file.skip(voxel_offset(header, path) - sizeof header);
  parallel_resize(raw.bytes, needed, 1);
  file.read(raw.bytes.data(), needed);
  file.expect_end();
  if (is_swapped && bytes_of(raw.type) > 1)
    nifti_swap_Nbytes(needed / bytes_of(raw.type), static_cast<int>(bytes_of(raw.type)), raw.bytes.data());
  return raw;
}

}  // namespace podm
