// NIfTI with sheared or scaled directions, which ITK 5.2 does not accept.
#include <nifti/nifti1_io.h>

#include <cstring>
#include <memory>

#include "image/read_formats.h"

namespace podm {

namespace {

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
      refuse(path, "one plain number a voxel is needed (NIfTI datatype " + std::to_string(datatype) + ")");
  }
}

}  // namespace

RawImage read_with_libnifti(const std::string& path) {
  nifti_set_debug_level(0);
  const std::unique_ptr<nifti_image, void (*)(nifti_image*)> image(nifti_image_read(path.c_str(), 0),
                                                                   nifti_image_free);
  if (!image) refuse(path, "not a NIfTI file");
  RawImage raw;
  raw.path = path;
  for (int axis = 1; axis <= image->ndim; ++axis) raw.size.push_back(image->dim[axis]);
  raw.type = voxel_type(path, image->datatype);
  const std::size_t needed = checked_num_voxels(path, raw.size) * bytes_of(raw.type);
  if (nifti_image_load(image.get()) != 0 || image->data == nullptr ||
      image->nvox * static_cast<std::size_t>(image->nbyper) < needed) {
    refuse(path, "the voxels cannot be read");
  }
  raw.bytes.resize(needed);
  std::memcpy(raw.bytes.data(), image->data, needed);
  if (image->sform_code == 0 && image->qform_code == 0) refuse(path, "the header has no affine");
  const mat44& a = image->sform_code > 0 ? image->sto_xyz : image->qto_xyz;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column)
      raw.voxel_to_ras[4 * row + column] = static_cast<double>(a.m[row][column]);
  }
  return raw;
}

}  // namespace podm
