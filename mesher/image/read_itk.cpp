// Reads NRRD and MetaImage through ITK's readers. The true size of the voxel data is checked first.
// The layers of a segmentation of 3D Slicer are the components of a vector for ITK, which puts them first.
// Compressed voxels of a MetaImage are read here: ITK reads as many bytes as the header announces, whatever
// the stream needs. If another program has changed the image, the header may still announce the old number.
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>

#include "image/read_formats.h"
#include "image/segments.h"
#include "image/voxel_data.h"

namespace podm {

namespace {

bool is_nrrd(const std::string& path) { return path.ends_with(".nrrd") || path.ends_with(".nhdr"); }

itk::ImageIOBase::Pointer reader_for(const std::string& path) {
  if (is_nrrd(path)) return itk::NrrdImageIO::New().GetPointer();
  return itk::MetaImageIO::New().GetPointer();
}

// Sets the layers, which are components for ITK, and their segments.
void read_layers(RawImage& raw, const itk::ImageIOBase& io) {
  raw.num_layers = io.GetNumberOfComponents();
  std::map<std::string, std::string> fields;
  const itk::MetaDataDictionary& header = io.GetMetaDataDictionary();
  for (const std::string& key : header.GetKeys())
    if (std::string text; itk::ExposeMetaData(header, key, text)) fields[key] = text;
  if (is_nrrd(raw.path)) raw.segments = parse_segments(raw.path, fields, raw.num_layers);
  if (raw.num_layers != 1 && raw.segments.empty())
    refuse(raw.path, "one value per voxel is needed, this image has " + std::to_string(raw.num_layers));
}

VoxelType voxel_type(const std::string& path, const itk::ImageIOBase& io) {
  switch (io.GetComponentType()) {
    case itk::ImageIOBase::UCHAR:
      return VoxelType::kUint8;
    case itk::ImageIOBase::CHAR:
      return VoxelType::kInt8;
    case itk::ImageIOBase::USHORT:
      return VoxelType::kUint16;
    case itk::ImageIOBase::SHORT:
      return VoxelType::kInt16;
    case itk::ImageIOBase::UINT:
      return VoxelType::kUint32;
    case itk::ImageIOBase::INT:
      return VoxelType::kInt32;
    case itk::ImageIOBase::ULONG:
    case itk::ImageIOBase::ULONGLONG:
      return VoxelType::kUint64;
    case itk::ImageIOBase::LONG:
    case itk::ImageIOBase::LONGLONG:
      return VoxelType::kInt64;
    case itk::ImageIOBase::FLOAT:
      return VoxelType::kFloat;
    case itk::ImageIOBase::DOUBLE:
      return VoxelType::kDouble;
    default:
      refuse(path, "unknown voxel type");
  }
}

// ITK's world frame is LPS.
std::array<double, 12> voxel_to_ras(const std::string& path, const itk::ImageIOBase& io) {
  std::array<double, 12> a{};
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (!(io.GetSpacing(axis) > 0))
      refuse(path, "the voxel spacing is not positive (axis " + std::to_string(axis) + ")");
  }
  for (unsigned row = 0; row < 3; ++row) {
    const double flip = row < 2 ? -1 : 1;
    for (unsigned column = 0; column < 3; ++column) {
      a[4 * row + column] = flip * io.GetDirection(column)[row] * io.GetSpacing(column);
    }
    a[4 * row + 3] = flip * io.GetOrigin(row);
  }
  return a;
}

std::string one_line(std::string text) {
  const std::size_t colon = text.rfind("): ");
  if (colon != std::string::npos) text = text.substr(colon + 3);
  for (char& c : text) c = c == '\n' ? ' ' : c;
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

void read_voxels(itk::ImageIOBase& io, RawImage& raw, std::size_t needed) {
  raw.bytes.resize(needed);
  itk::ImageIORegion region(io.GetNumberOfDimensions());
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
    region.SetIndex(axis, 0);
    region.SetSize(axis, io.GetDimensions(axis));
  }
  io.SetIORegion(region);
  io.Read(raw.bytes.data());
}

void read_compressed_voxels(const VoxelData& data, RawImage& raw, std::size_t needed) {
  static_assert(std::endian::native == std::endian::little);
  raw.bytes = decompressed_voxels(raw.path, data, needed, raw.warnings);
  if (data.is_big_endian) swap_bytes(raw.bytes, bytes_of(raw.type));
}

VoxelData find_voxels(const std::string& path) {
  return is_nrrd(path) ? find_nrrd_voxels(path) : find_meta_voxels(path);
}

RawImage read_size_and_type(itk::ImageIOBase& io, const std::string& path) {
  constexpr itk::SizeValueType kLongestAxis = std::numeric_limits<int>::max();
  RawImage raw;
  raw.path = path;
  if (!io.CanReadFile(path.c_str()))
    refuse(path, "not a file of the format of its name (wrong magic or header)");
  io.SetFileName(path);
  io.ReadImageInformation();
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis)
    raw.size.push_back(static_cast<int>(std::min<itk::SizeValueType>(io.GetDimensions(axis), kLongestAxis)));
  read_layers(raw, io);
  raw.type = voxel_type(path, io);
  return raw;
}

// Returns read(), and refuses the file with ITK's reason if ITK fails.
template <class Read>
auto of_itk(const std::string& path, const Read& read) {
  try {
    return read();
  } catch (const itk::ExceptionObject& error) {
    refuse(path, "cannot be read (" + one_line(error.GetDescription()) + ")");
  }
}

}  // namespace

ImageHead read_head_with_itk(const std::string& path) {
  const VoxelData data = find_voxels(path);
  const itk::ImageIOBase::Pointer io = reader_for(path);
  return of_itk(path, [&] {
    ImageHead head{read_size_and_type(*io, path), data};
    head.image.voxel_to_ras = voxel_to_ras(path, *io);
    return head;
  });
}

RawImage read_with_itk(const std::string& path, std::uint64_t most_bytes) {
  const VoxelData data = find_voxels(path);
  const itk::ImageIOBase::Pointer io = reader_for(path);
  return of_itk(path, [&] {
    RawImage raw = read_size_and_type(*io, path);
    const std::size_t needed = checked_num_bytes(raw, most_bytes);
    if (data.is_compressed && !is_nrrd(path)) {
      read_compressed_voxels(data, raw, needed);
    } else {
      expect_voxel_bytes(path, data, needed);
      read_voxels(*io, raw, needed);
    }
    raw.voxel_to_ras = voxel_to_ras(path, *io);
    return raw;
  });
}

}  // namespace podm
