// INRIMAGE-4: a text header padded to a multiple of 256 bytes, then the voxels.
#include <charconv>
#include <map>
#include <sstream>

#include "image/byte_source.h"
#include "image/raw_image.h"

namespace podm::verify {

namespace {

constexpr std::size_t kHeaderUnit = 256, kLongestHeader = 256 * kHeaderUnit;

class Header {
 public:
  Header(const std::string& path, ByteSource& source) : path_(path) {
    std::string text;
    std::size_t end = std::string::npos;
    while (end == std::string::npos) {
      if (text.size() == kLongestHeader) refuse(path, "the INR header has no end");
      text.resize(text.size() + kHeaderUnit);
      source.read(&text[text.size() - kHeaderUnit], kHeaderUnit);
      if (!text.starts_with("#INRIMAGE-4#{")) refuse(path, "not an INRIMAGE-4 file (wrong magic)");
      end = text.find("##}");
    }
    std::istringstream lines(text.substr(0, end));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t equals = line.find('=');
      if (line.empty() || line[0] == '#' || equals == std::string::npos) continue;
      fields_[line.substr(0, equals)] = line.substr(equals + 1, line.find_last_not_of(" \r") - equals);
    }
  }

  std::string text(const std::string& key) const {
    const auto field = fields_.find(key);
    return field == fields_.end() ? "" : field->second;
  }
  // Reads "8 bits" as 8.
  template <class Number>
  Number number(const std::string& key, Number otherwise) const {
    if (!fields_.contains(key)) return otherwise;
    const std::string value = text(key);
    Number parsed{};
    if (std::from_chars(value.data(), value.data() + value.size(), parsed).ec != std::errc{})
      refuse(path_, "INR header: " + key + " is not a number ('" + value + "')");
    return parsed;
  }

 private:
  const std::string& path_;
  std::map<std::string, std::string> fields_;
};

VoxelType voxel_type(const std::string& path, const Header& header) {
  static const std::map<std::pair<std::string, int>, VoxelType> kTypes{
      {{"unsigned fixed", 8}, VoxelType::kUint8},   {{"unsigned fixed", 16}, VoxelType::kUint16},
      {{"unsigned fixed", 32}, VoxelType::kUint32}, {{"signed fixed", 8}, VoxelType::kInt8},
      {{"signed fixed", 16}, VoxelType::kInt16},    {{"signed fixed", 32}, VoxelType::kInt32},
      {{"float", 32}, VoxelType::kFloat},           {{"float", 64}, VoxelType::kDouble}};
  const std::string type = header.text("TYPE");
  const int bits = header.number("PIXSIZE", 0);
  const auto known = kTypes.find({type, bits});
  if (known == kTypes.end())
    refuse(path, "INR header: unknown voxel type ('" + type + "', " + std::to_string(bits) + " bits)");
  return known->second;
}

bool is_big_endian(const std::string& path, const std::string& cpu) {
  if (cpu == "sun" || cpu == "sgi") return true;
  if (cpu == "decm" || cpu == "alpha" || cpu == "pc") return false;
  refuse(path, "INR header: unknown CPU '" + cpu + "'");
}

}  // namespace

RawImage read_inr(const std::string& path) {
  ByteSource source(path, path, 0, Compression::kIfGzipped);
  const Header header(path, source);
  RawImage raw;
  for (const char* key : {"XDIM", "YDIM", "ZDIM"}) raw.size.push_back(header.number(key, std::int64_t{0}));
  if (header.number("VDIM", 1) != 1) refuse(path, "one value per voxel is needed (VDIM is not 1)");
  raw.type = voxel_type(path, header);
  raw.is_swapped = is_big_endian(path, header.text("CPU"));
  const std::array<const char*, 3> spacing{"VX", "VY", "VZ"}, offset{"TX", "TY", "TZ"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    raw.voxel_to_ras[5 * axis] = header.number(spacing[axis], 1.0);
    if (!(raw.voxel_to_ras[5 * axis] > 0))
      refuse(path, std::string("INR header: ") + spacing[axis] + " is not positive");
    raw.voxel_to_ras[4 * axis + 3] = header.number(offset[axis], 0.0);
  }
  read_voxels(path, raw, source);
  return raw;
}

}  // namespace podm::verify
