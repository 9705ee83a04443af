// Image files made for a test, in a folder that is removed with them.
#pragma once

#include <nifti/nifti1.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace podm::verify {

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "podm-verify-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (path_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

 private:
  std::filesystem::path path_;
};

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

/// Returns a file of 2 x 3 x 4 voxels of 1, 2, 3 mm, with an sform without rotation.
template <class Change>
std::string nifti_file(const std::string& voxels, Change change) {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  header.dim[0] = 3;
  for (int i = 1; i < 8; ++i) header.dim[i] = static_cast<std::int16_t>(i < 4 ? i + 1 : 1);
  header.datatype = DT_UINT8;
  header.bitpix = 8;
  header.pixdim[0] = 1;
  for (int axis = 1; axis < 4; ++axis) header.pixdim[axis] = static_cast<float>(axis);
  header.vox_offset = 352;
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  header.srow_x[0] = 1;
  header.srow_y[1] = 2;
  header.srow_z[2] = 3;
  std::memcpy(header.magic, "n+1", 4);
  change(header);
  std::string bytes(352, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes + voxels;
}
inline std::string nifti_file(const std::string& voxels) {
  return nifti_file(voxels, [](nifti_1_header&) {});
}

/// Returns 24 values: 7 at the origin, 5 at its x neighbour, 0 elsewhere.
template <class T>
std::vector<T> two_voxels() {
  std::vector<T> voxels(24, T{0});
  voxels[0] = T{7};
  voxels[1] = T{5};
  return voxels;
}
inline const std::string kVoxels = bytes_of_values(two_voxels<std::uint8_t>());

inline std::string inr_header(
    const std::string& fields,
    const std::string& basic =
        "XDIM=2\nYDIM=3\nZDIM=4\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=decm\n") {
  std::string header = "#INRIMAGE-4#{\n" + basic + fields;
  header.resize(256 - 4, '\n');
  return header + "##}\n";
}

inline const std::string kNrrdHeader =
    "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 4\n"
    "space directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (10,20,30)\nendian: little\n";

inline const std::string kMetaHeader =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 1 2 3\nDimSize = 2 3 4\n"
    "ElementType = MET_UCHAR\n";

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace podm::verify
