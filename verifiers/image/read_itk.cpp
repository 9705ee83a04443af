// NRRD and MetaImage. ITK reads the headers. The voxels are read here, since ITK fills missing voxels with
// zeros or leaves them uninitialized.
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <bit>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "image/byte_source.h"
#include "image/raw_image.h"
#include "image/segmentation.h"

namespace podm::verify {

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
}

// The lines "key SEPARATOR value" up to and including the line whose key is spelled `last`.
class TextHeader {
 public:
  TextHeader(const std::string& path, char separator, const std::string& last) {
    constexpr std::uint64_t kLongest = 1 << 20;
    file_bytes(path, path);
    std::ifstream file(path, std::ios::binary);
    for (std::string line, key = "-"; key != last && std::getline(file, line);) {
      bytes_ += line.size() + 1;
      if (bytes_ > kLongest) refuse(path, "the header has no end");
      lines_.push_back(line);
      const std::size_t at = line.find(separator);
      key = trimmed(line.substr(0, at));
      if (at != std::string::npos && !key.starts_with('#'))
        fields_[lower(key)] = trimmed(line.substr(at + 1));
    }
  }
  std::string operator[](const std::string& key) const {
    const auto found = fields_.find(key);
    return found == fields_.end() ? "" : found->second;
  }
  std::uint64_t bytes() const { return bytes_; }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
  std::map<std::string, std::string> fields_;  // keys in lower case
  std::uint64_t bytes_ = 0;
};

// Returns the path of a file that the header of `path` names.
std::string beside(const std::string& path, const std::string& name) {
  const std::string file = (std::filesystem::path(path).parent_path() / name).string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    refuse(path, "its voxels are missing: no file '" + name + "' beside it");
  return file;
}

// Facts about the voxels that ITK does not report, or not for every file.
struct Voxels {
  ByteSource source;
  bool is_big_endian;
  std::string announced_bytes = {};               // compressed size by the header; empty: not given
  std::string kinds = {};                         // of the axes of a NRRD file
  std::map<std::string, std::string> pairs = {};  // "key:=value" of a NRRD file
};

// ITK decides by the first letter that a value is true.
bool is_true(const std::string& flag) {
  return !flag.empty() && std::string("tT1").find(flag[0]) != std::string::npos;
}

// Throws unless ITK can read the lines safely. ITK quotes the path and a line that it does not understand in
// messages of a thousand bytes. It understands comments and 'name:=value'.
void expect_nrrd_lines(const std::string& path, const std::vector<std::string>& lines) {
  constexpr std::size_t kMostQuoted = 500;
  if (path.size() > kMostQuoted) refuse(path, "a NRRD file needs a path of at most 500 bytes");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t colon = lines[i].find(':');
    const bool is_named = colon != std::string::npos && lines[i].compare(colon, 2, ":=") == 0;
    const bool is_free = lines[i].starts_with('#') || is_named;
    if (lines[i].size() > kMostQuoted && (i == 0 || !is_free))
      refuse(path, "the NRRD header has a line of more than 500 bytes, line " + std::to_string(i + 1));
  }
}

std::map<std::string, std::string> pairs_in(const std::vector<std::string>& lines) {
  std::map<std::string, std::string> pairs;
  for (const std::string& line : lines)
    if (const std::size_t at = line.find(":="); at != std::string::npos && !line.starts_with('#'))
      pairs[line.substr(0, at)] = trimmed(line.substr(at + 2));
  return pairs;
}

Voxels nrrd_voxels(const std::string& path) {
  std::array<char, 4> magic{};
  std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  file_bytes(path, path);
  if (std::string(magic.data(), magic.size()) != "NRRD") refuse(path, "not a NRRD file (wrong magic)");
  const TextHeader header(path, ':', "");
  expect_nrrd_lines(path, header.lines());
  for (const char* key : {"line skip", "lineskip", "byte skip", "byteskip"})
    if (!header[key].empty() && header[key] != "0")
      refuse(path, std::string("'") + key + "' is not supported");
  const std::string encoding = lower(header["encoding"]), file = header["data file"] + header["datafile"];
  if (encoding != "gzip" && encoding != "gz" && encoding != "raw")
    refuse(path, "encoding '" + encoding + "' is not supported (raw and gzip are)");
  const Compression compression = encoding == "raw" ? Compression::kNone : Compression::kStream;
  const bool is_big_endian = lower(header["endian"]) == "big";
  const bool is_beside = !file.empty();
  return {{path, is_beside ? beside(path, file) : path, is_beside ? 0 : header.bytes(), compression},
          is_big_endian,
          {},
          lower(header["kinds"]),
          pairs_in(header.lines())};
}

// Throws unless ITK can read the lines safely. ITK has 255 bytes for a name or a comment. If a name has no
// '=', it goes on to the next '=', on whatever line.
void expect_meta_lines(const std::string& path, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool is_field = lines[i].find('=') < lines[i].find(':');
    if (lines[i].size() < 255 && (is_field || trimmed(lines[i]).empty())) continue;
    refuse(path, "not a MetaImage header (wrong magic, or a line " + std::to_string(i + 1) +
                     " that is not 'name = value' of less than 255 bytes)");
  }
}

Voxels meta_voxels(const std::string& path) {
  const TextHeader header(path, '=', "ElementDataFile");
  expect_meta_lines(path, header.lines());
  const std::string file = header["elementdatafile"];
  if (header["ndims"].empty() || file.empty()) refuse(path, "not a MetaImage file (wrong magic)");
  if (header["ndims"] != "3") refuse(path, "a 3-D image is needed (NDims = " + header["ndims"] + ")");
  if (!header["headersize"].empty() && header["headersize"] != "0")
    refuse(path, "'HeaderSize' is not supported");
  if (!header["binarydata"].empty() && !is_true(header["binarydata"]))
    refuse(path, "voxels written as text are not supported");
  for (const char* key : {"dimsize", "elementtype"})  // ITK only prints which key is missing
    if (header[key].empty()) refuse(path, std::string("the MetaImage header has no '") + key + "'");
  const bool is_compressed = is_true(header["compresseddata"]);
  const Compression compression = is_compressed ? Compression::kStream : Compression::kNone;
  const bool is_big_endian =
      is_true(header["binarydatabyteordermsb"]) || is_true(header["elementbyteordermsb"]);
  const std::string announced = is_compressed ? header["compresseddatasize"] : "";
  if (file == "LOCAL" || file == "Local" || file == "local")  // the spellings that ITK accepts
    return {{path, path, header.bytes(), compression}, is_big_endian, announced};
  return {{path, beside(path, file), 0, compression}, is_big_endian, announced};
}

VoxelType voxel_type(const std::string& path, const itk::ImageIOBase& io) {
  using Io = itk::ImageIOBase;
  static const std::map<Io::IOComponentEnum, VoxelType> kTypes{
      {Io::UCHAR, VoxelType::kUint8},   {Io::CHAR, VoxelType::kInt8},
      {Io::USHORT, VoxelType::kUint16}, {Io::SHORT, VoxelType::kInt16},
      {Io::UINT, VoxelType::kUint32},   {Io::INT, VoxelType::kInt32},
      {Io::ULONG, VoxelType::kUint64},  {Io::ULONGLONG, VoxelType::kUint64},
      {Io::LONG, VoxelType::kInt64},    {Io::LONGLONG, VoxelType::kInt64},
      {Io::FLOAT, VoxelType::kFloat},   {Io::DOUBLE, VoxelType::kDouble}};
  const auto known = kTypes.find(io.GetComponentType());
  if (known == kTypes.end()) refuse(path, "unknown voxel type");
  return known->second;
}

// Sets the layers, which ITK takes for components of a vector, and the segments.
void read_layers(const std::string& path, const itk::ImageIOBase& io, const Voxels& voxels, RawImage& raw) {
  raw.num_layers = io.GetNumberOfComponents();
  raw.segments = read_segments(path, voxels.pairs, raw.num_layers);
  if (raw.num_layers == 1) return;
  if (raw.segments.empty())
    refuse(path, "one value per voxel is needed, this image has " + std::to_string(raw.num_layers));
  const std::set<std::string> of_space{"domain", "space", "time", "???", "none"};  // by ITK
  std::istringstream words(voxels.kinds);
  for (std::string kind; words >> kind && of_space.contains(kind);) ++raw.layer_axis;
}

// ITK's world is LPS.
std::array<double, 12> voxel_to_ras(const std::string& path, const itk::ImageIOBase& io) {
  std::array<double, 12> a{};
  for (unsigned row = 0; row < 3; ++row) {
    if (!(io.GetSpacing(row) > 0))
      refuse(path, "the voxel spacing is not positive (axis " + std::to_string(row) + ")");
    const double flip = row < 2 ? -1 : 1;
    for (unsigned column = 0; column < 3; ++column)
      a[4 * row + column] = flip * io.GetDirection(column)[row] * io.GetSpacing(column);
    a[4 * row + 3] = flip * io.GetOrigin(row);
  }
  return a;
}

std::string one_line(std::string text) {
  const std::size_t place = text.rfind("): ");  // end of ITK's note on its own source
  if (place != std::string::npos) text = text.substr(place + 3);
  for (char& c : text) c = c == '\n' ? ' ' : c;
  return trimmed(text);
}

RawImage read(const std::string& path, itk::ImageIOBase& io, Voxels voxels) {
  RawImage raw;
  try {
    if (!io.CanReadFile(path.c_str()))
      refuse(path, "not a file of the format its name promises (wrong magic or header)");
    io.SetFileName(path);
    io.ReadImageInformation();
  } catch (const itk::ExceptionObject& error) {
    refuse(path, "cannot be read (" + one_line(error.GetDescription()) + ")");
  }
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis)
    raw.size.push_back(static_cast<std::int64_t>(io.GetDimensions(axis)));
  read_layers(path, io, voxels, raw);
  raw.type = voxel_type(path, io);
  raw.is_swapped = voxels.is_big_endian != (std::endian::native == std::endian::big);
  if (raw.size.size() >= 3) raw.voxel_to_ras = voxel_to_ras(path, io);
  read_voxels(path, raw, voxels.source);
  const std::string taken = std::to_string(voxels.source.compressed_bytes());
  if (!voxels.announced_bytes.empty() && voxels.announced_bytes != taken)
    raw.warnings.push_back(path + ": CompressedDataSize is " + voxels.announced_bytes +
                           ", but the stream has " + taken + " bytes; it is whole, and was read to its end");
  return raw;
}

}  // namespace

RawImage read_nrrd(const std::string& path) {
  return read(path, *itk::NrrdImageIO::New(), nrrd_voxels(path));
}

RawImage read_meta(const std::string& path) {
  return read(path, *itk::MetaImageIO::New(), meta_voxels(path));
}

}  // namespace podm::verify
