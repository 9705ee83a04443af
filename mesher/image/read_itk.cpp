// NIfTI, NRRD and MetaImage through ITK's readers, guarded: these libraries fill what is missing with zeros,
// so the data's true size is checked first.
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <filesystem>

#include "image/read_formats.h"

namespace podm {

namespace {

bool ends_with(const std::string& path, const std::string& ending) {
  return path.size() >= ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

itk::ImageIOBase::Pointer reader_for(const std::string& path) {
  if (is_nifti_name(path)) return itk::NiftiImageIO::New().GetPointer();
  if (ends_with(path, ".nrrd") || ends_with(path, ".nhdr")) return itk::NrrdImageIO::New().GetPointer();
  return itk::MetaImageIO::New().GetPointer();
}

VoxelType voxel_type(const std::string& path, const itk::ImageIOBase& io) {
  if (io.GetNumberOfComponents() != 1) {
    refuse(path, "one value a voxel is needed, this image has " + std::to_string(io.GetNumberOfComponents()));
  }
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

// ITK's world is LPS.
std::array<double, 12> voxel_to_ras(const itk::ImageIOBase& io) {
  std::array<double, 12> a{};
  for (unsigned row = 0; row < 3; ++row) {
    const double flip = row < 2 ? -1 : 1;
    for (unsigned column = 0; column < 3; ++column) {
      a[4 * row + column] = flip * io.GetDirection(column)[row] * io.GetSpacing(column);
    }
    a[4 * row + 3] = flip * io.GetOrigin(row);
  }
  return a;
}

// A compressed file can hold a thousand times its size, no more (deflate's limit is 1032).
void check_plausible(const std::string& path, std::size_t bytes_needed) {
  constexpr std::size_t kLargestRatio = 1100;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && !ends_with(path, ".mhd") && !ends_with(path, ".nhdr") && !ends_with(path, ".hdr") &&
      bytes_needed / kLargestRatio > size) {
    refuse(path, "truncated: the header announces " + std::to_string(bytes_needed) + " bytes of voxels");
  }
}

void check_nifti_data(const std::string& path, std::size_t bytes_needed) {
  const std::size_t found = read_bytes(path).size();
  constexpr std::size_t kSmallestHeader = 348;
  const std::size_t header = ends_with(path, ".img") || ends_with(path, ".img.gz") ? 0 : kSmallestHeader;
  if (found < header + bytes_needed) {
    refuse(path, "truncated: the header announces " + std::to_string(bytes_needed) +
                     " bytes of voxels, the file holds " + std::to_string(found - std::min(found, header)));
  }
}

std::string one_line(std::string text) {
  const std::size_t colon = text.rfind("): ");
  if (colon != std::string::npos) text = text.substr(colon + 3);
  for (char& c : text) c = c == '\n' ? ' ' : c;
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace

bool is_nifti_name(const std::string& path) {
  for (const char* ending : {".nii", ".nii.gz", ".hdr", ".img", ".img.gz"}) {
    if (ends_with(path, ending)) return true;
  }
  return false;
}

RawImage read_with_itk(const std::string& path) {
  const itk::ImageIOBase::Pointer io = reader_for(path);
  RawImage raw;
  raw.path = path;
  try {
    if (!io->CanReadFile(path.c_str()))
      refuse(path, "not a file of the format its name promises (wrong magic or header)");
    io->SetFileName(path);
    io->ReadImageInformation();
    for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis) {
      raw.size.push_back(static_cast<int>(std::min<itk::SizeValueType>(io->GetDimensions(axis), 1u << 30)));
    }
    raw.type = voxel_type(path, *io);
    const std::size_t needed = checked_num_voxels(path, raw.size) * bytes_of(raw.type);
    check_plausible(path, needed);
    if (is_nifti_name(path) && !ends_with(path, ".hdr")) check_nifti_data(path, needed);
    raw.voxel_to_ras = voxel_to_ras(*io);
    raw.bytes.resize(needed);
    itk::ImageIORegion region(io->GetNumberOfDimensions());
    for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis) {
      region.SetIndex(axis, 0);
      region.SetSize(axis, io->GetDimensions(axis));
    }
    io->SetIORegion(region);
    io->Read(raw.bytes.data());
  } catch (const itk::ExceptionObject& error) {
    const std::string text = one_line(error.GetDescription());
    if (is_nifti_name(path) && text.find("orthonormal") != std::string::npos) return read_with_libnifti(path);
    refuse(path, "cannot be read (" + text + ")");
  }
  return raw;
}

}  // namespace podm
