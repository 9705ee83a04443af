// Makes the bytes of image files for tests.
#pragma once

#include <nifti/nifti1.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace podm {

/// `window_bits` as in zlib: 31 for gzip, 15 for a zlib stream.
inline std::string deflated(const std::string& bytes, int window_bits = 31) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, window_bits, 9, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

template <class T>
std::string bytes_of_values(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A 2 x 3 x 4 uint8 header with an sform of 1, 2, 3 mm along the axes.
inline nifti_1_header nifti_header() {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  header.dim[0] = 3;
  header.dim[1] = 2;
  header.dim[2] = 3;
  header.dim[3] = 4;
  for (int i = 4; i < 8; ++i) header.dim[i] = 1;
  header.datatype = DT_UINT8;
  header.bitpix = 8;
  header.pixdim[0] = 1;
  for (int axis = 1; axis < 4; ++axis) header.pixdim[axis] = static_cast<float>(axis);
  header.vox_offset = 352;
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.srow_x[0] = 1;
  header.srow_y[1] = 2;
  header.srow_z[2] = 3;
  header.xyzt_units = NIFTI_UNITS_MM;
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

inline std::string nifti_file(const nifti_1_header& header, const std::string& voxels) {
  std::string bytes(352, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes + voxels;
}

/// 24 voxels: 7 at the origin, 5 at its x neighbor, 0 elsewhere.
inline std::vector<std::uint8_t> two_voxels() {
  std::vector<std::uint8_t> voxels(24, 0);
  voxels[0] = 7;
  voxels[1] = 5;
  return voxels;
}
inline const std::string kVoxels = bytes_of_values(two_voxels());

/// The header of an INR image of 2 x 3 x 4 voxels with `fields` in front of the usual ones.
inline std::string inr_header(const std::string& fields,
                              const std::string& dims = "XDIM=2\nYDIM=3\nZDIM=4\nVDIM=1\n",
                              const std::string& type = "TYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=decm\n") {
  std::string header = "#INRIMAGE-4#{\n" + dims + fields + type;
  header.resize(256 - 4, '\n');
  return header + "##}\n";
}

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? throw std::logic_error("no '" + what + "'")
                                 : text.replace(at, what.size(), by);
}

inline std::string nrrd_header(const std::string& fields) { return "NRRD0004\n" + fields + "\n"; }
inline const std::string kNrrdFields =
    "type: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 4\n"
    "space directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (10,20,30)\nendian: little\n";

inline std::string mha_header(const std::string& fields) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" + fields;
}
inline const std::string kMhaFields =
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 1 2 3\nDimSize = 2 3 4\n"
    "ElementType = MET_UCHAR\n";
inline const std::string kMhaLocal = "ElementDataFile = LOCAL\n";

}  // namespace podm
