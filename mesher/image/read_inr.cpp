// INRIMAGE-4: a text header padded to a multiple of 256 bytes, then the voxels.
#include <algorithm>
#include <bit>
#include <charconv>
#include <map>
#include <sstream>

#include "image/input_file.h"
#include "image/read_formats.h"
#include "runtime/parallel_resize.h"

namespace podm {

namespace {

constexpr std::size_t kHeaderUnit = 256;
constexpr std::size_t kLongestHeader = 256 * kHeaderUnit;
constexpr const char* kMagic = "#INRIMAGE-4#{";

using Header = std::map<std::string, std::string>;

Header read_header(InputFile& file, const std::string& path) {
  std::string text;
  std::size_t end = std::string::npos;
  while (end == std::string::npos) {
    if (text.size() == kLongestHeader) refuse(path, "the INR header has no end");
    text.resize(text.size() + kHeaderUnit);
    file.read(&text[text.size() - kHeaderUnit], kHeaderUnit);
    if (!text.starts_with(kMagic)) refuse(path, "not an INRIMAGE-4 file (wrong magic)");
    end = text.find("##}");
  }
  Header header;
  std::istringstream lines(text.substr(0, end));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    if (line.empty() || line[0] == '#' || equals == std::string::npos) continue;
    std::string value = line.substr(equals + 1);
    while (!value.empty() && (value.back() == '\r' || value.back() == ' ')) value.pop_back();
    header[line.substr(0, equals)] = value;
  }
  return header;
}

template <class Number>
Number number(const std::string& path, const Header& header, const std::string& key, Number otherwise) {
  const auto field = header.find(key);
  if (field == header.end()) return otherwise;
  Number value{};
  const std::string& text = field->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) refuse(path, "INR header: " + key + " is not a number ('" + text + "')");
  return value;
}

VoxelType voxel_type(const std::string& path, const Header& header) {
  const auto field = header.find("TYPE");
  const std::string type = field == header.end() ? "" : field->second;
  const int bits = number(path, header, "PIXSIZE", 0);
  if (type == "unsigned fixed" && bits == 8) return VoxelType::kUint8;
  if (type == "unsigned fixed" && bits == 16) return VoxelType::kUint16;
  if (type == "unsigned fixed" && bits == 32) return VoxelType::kUint32;
  if (type == "signed fixed" && bits == 8) return VoxelType::kInt8;
  if (type == "signed fixed" && bits == 16) return VoxelType::kInt16;
  if (type == "signed fixed" && bits == 32) return VoxelType::kInt32;
  if (type == "float" && bits == 32) return VoxelType::kFloat;
  if (type == "float" && bits == 64) return VoxelType::kDouble;
  refuse(path, "INR header: unknown voxel type ('" + type + "', " + std::to_string(bits) + " bits)");
}

bool is_big_endian(const std::string& path, const Header& header) {
  const auto field = header.find("CPU");
  if (field == header.end()) refuse(path, "INR header: CPU is missing");
  if (field->second == "sun" || field->second == "sgi") return true;
  if (field->second == "decm" || field->second == "alpha" || field->second == "pc") return false;
  refuse(path, "INR header: unknown CPU '" + field->second + "'");
}

}  // namespace

RawImage read_inr(const std::string& path, std::uint64_t most_bytes) {
  static_assert(std::endian::native == std::endian::little);
  InputFile file(path);
  const Header header = read_header(file, path);
  RawImage raw;
  raw.path = path;
  raw.size = {number(path, header, "XDIM", 0), number(path, header, "YDIM", 0),
              number(path, header, "ZDIM", 0)};
  if (number(path, header, "VDIM", 1) != 1) refuse(path, "one value per voxel is needed (VDIM is not 1)");
  raw.type = voxel_type(path, header);
  const std::size_t needed = checked_num_bytes(raw, most_bytes);
  file.expect_room_for(needed);
  parallel_resize(raw.bytes, needed, 1);
  file.read(raw.bytes.data(), needed);
  file.expect_end();
  if (is_big_endian(path, header)) swap_bytes(raw.bytes, bytes_of(raw.type));
  const std::array<const char*, 3> spacing{"VX", "VY", "VZ"}, offset{"TX", "TY", "TZ"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double s = number(path, header, spacing[axis], 1.0);
    if (!(s > 0)) refuse(path, std::string("INR header: ") + spacing[axis] + " is not positive");
    raw.voxel_to_ras[5 * axis] = s;
    raw.voxel_to_ras[4 * axis + 3] = number(path, header, offset[axis], 0.0);
  }
  return raw;
}

}  // namespace podm
