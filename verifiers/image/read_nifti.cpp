// NIfTI-1 by libnifti's header functions. ITK's reader is not used: it refuses shear or takes the qform
// instead in silence, aborts on an affine that is not finite, and fills missing voxels with zeros.
#include <nifti/nifti1_io.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "image/byte_source.h"
#include "image/raw_image.h"

namespace podm::verify {

namespace {

nifti_1_header read_header(const std::string& path, ByteSource& source, bool& is_swapped) {
  nifti_1_header header{};
  constexpr int kNifti2Bytes = 540;
  source.read(&header, sizeof header);
  int bytes = header.sizeof_hdr;
  is_swapped = bytes != sizeof header && bytes != kNifti2Bytes;
  if (is_swapped) nifti_swap_4bytes(1, &bytes);
  if (bytes == kNifti2Bytes) refuse(path, "NIfTI-2 is not supported (NIfTI-1 is)");
  if (bytes != sizeof header || std::memcmp(header.magic, "n+1", 4) != 0)
    refuse(path, "not a NIfTI-1 file (wrong magic)");
  if (is_swapped) swap_nifti_header(&header, 1);
  if (header.dim[0] < 1 || header.dim[0] > 7)
    refuse(path, "not a NIfTI-1 file (" + std::to_string(header.dim[0]) + " dimensions)");
  return header;
}

VoxelType voxel_type(const std::string& path, int datatype) {
  static const std::map<int, VoxelType> kTypes{
      {DT_UINT8, VoxelType::kUint8},    {DT_INT8, VoxelType::kInt8},     {DT_UINT16, VoxelType::kUint16},
      {DT_INT16, VoxelType::kInt16},    {DT_UINT32, VoxelType::kUint32}, {DT_INT32, VoxelType::kInt32},
      {DT_UINT64, VoxelType::kUint64},  {DT_INT64, VoxelType::kInt64},   {DT_FLOAT32, VoxelType::kFloat},
      {DT_FLOAT64, VoxelType::kDouble},
  };
  const auto known = kTypes.find(datatype);
  if (known == kTypes.end())
    refuse(path, "one plain number a voxel is needed (NIfTI datatype " + std::to_string(datatype) + ")");
  return known->second;
}

// A header that names no unit means mm.
double unit_mm(const nifti_1_header& header) {
  const int unit = XYZT_TO_SPACE(header.xyzt_units);
  return unit == NIFTI_UNITS_METER ? 1000 : unit == NIFTI_UNITS_MICRON ? 0.001 : 1;
}

// The sform if there is one, else the qform, else the voxel sizes alone.
mat44 affine(const std::string& path, const nifti_1_header& h) {
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

}  // namespace

RawImage read_nifti(const std::string& path) {
  ByteSource source(path, path, 0, Compression::kIfGzipped);
  RawImage raw;
  const nifti_1_header header = read_header(path, source, raw.is_swapped);
  raw.size.assign(header.dim + 1, header.dim + 1 + header.dim[0]);
  raw.type = voxel_type(path, header.datatype);
  if (header.scl_slope != 0 && (header.scl_slope != 1 || header.scl_inter != 0))
    refuse(path, "a label image is needed (the header scales the voxels: scl_slope, scl_inter)");
  const mat44 a = affine(path, header);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      raw.voxel_to_ras[4 * row + column] = unit_mm(header) * static_cast<double>(a.m[row][column]);
  // An offset before the end of the header stands for that end.
  constexpr float kSmallestOffset = 352, kLargestOffset = 1 << 24;  // the latter exact in a float
  if (!(header.vox_offset <= kLargestOffset)) refuse(path, "the NIfTI header is damaged (vox_offset)");
  source.skip(static_cast<std::uint64_t>(std::max(header.vox_offset, kSmallestOffset)) - sizeof header);
  read_voxels(path, raw, source);
  return raw;
}

}  // namespace podm::verify
