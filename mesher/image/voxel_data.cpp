#include "image/voxel_data.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

#include "image/input_file.h"
#include "image/raw_image.h"

namespace podm {

namespace {

constexpr std::uint64_t kLongestHeader = 1 << 20;

struct TextHeader {
  std::map<std::string, std::string> fields;  // keys in lower case
  std::uint64_t bytes = 0;

  std::string field(const std::string& key) const {
    const auto found = fields.find(key);
    return found == fields.end() ? "" : found->second;
  }
};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
}

// Lines "key SEPARATOR value" until `is_last(key)`, the key of an empty line being empty, or the end.
template <class IsLast>
TextHeader read_text_header(const std::string& path, char separator, IsLast is_last) {
  file_bytes(path);
  std::ifstream file(path, std::ios::binary);
  TextHeader header;
  for (std::string line; std::getline(file, line);) {
    header.bytes += line.size() + 1;
    if (header.bytes > kLongestHeader) refuse(path, "the header has no end");
    const std::size_t at = line.find(separator);
    const std::string key = lower(trimmed(line.substr(0, at)));
    if (at != std::string::npos && key[0] != '#') header.fields[key] = trimmed(line.substr(at + 1));
    if (is_last(key)) break;
  }
  return header;
}

// Of a file named in the header of `path`.
std::string beside(const std::string& path, const std::string& name) {
  const std::string data_path = (std::filesystem::path(path).parent_path() / name).string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(data_path, error))
    refuse(path, "its voxels are missing (no file '" + name + "' beside it)");
  return data_path;
}

// Bytes that the stream makes; only counted, so that a hostile one costs time alone.
std::uint64_t decompressed_bytes(const std::string& path, std::ifstream& file) {
  constexpr int kZlibOrGzip = 32 + MAX_WBITS;
  z_stream stream{};
  if (inflateInit2(&stream, kZlibOrGzip) != Z_OK) refuse(path, "zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> closer(&stream, inflateEnd);
  std::array<char, 1 << 15> in;
  std::array<char, 1 << 17> out;
  std::uint64_t total = 0;
  for (int code = Z_OK; code != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      file.read(in.data(), in.size());
      stream.next_in = reinterpret_cast<Bytef*>(in.data());
      stream.avail_in = static_cast<uInt>(file.gcount());
      if (stream.avail_in == 0) refuse(path, "the file is truncated (its compressed voxels have no end)");
    }
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    code = inflate(&stream, Z_NO_FLUSH);
    if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
      refuse(path, "the compressed voxels are damaged");
    total += out.size() - stream.avail_out;
  }
  return total;
}

}  // namespace

VoxelData find_nrrd_voxels(const std::string& path) {
  std::array<char, 4> magic{};
  std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  file_bytes(path);
  if (std::string(magic.data(), magic.size()) != "NRRD") refuse(path, "not a NRRD file (wrong magic)");
  const TextHeader header = read_text_header(path, ':', [](const std::string& key) { return key.empty(); });
  for (const char* key : {"line skip", "lineskip", "byte skip", "byteskip"})
    if (const std::string skip = header.field(key); !skip.empty() && skip != "0")
      refuse(path, std::string("'") + key + "' is not supported");
  const std::string encoding = lower(header.field("encoding"));
  const bool is_compressed = encoding == "gzip" || encoding == "gz";
  if (!is_compressed && encoding != "raw")
    refuse(path, "encoding '" + encoding + "' is not supported (raw and gzip are)");
  const std::string file = header.field("data file") + header.field("datafile");
  if (file.empty()) return {path, header.bytes, is_compressed};
  return {beside(path, file), 0, is_compressed};
}

VoxelData find_meta_voxels(const std::string& path) {
  const TextHeader header =
      read_text_header(path, '=', [](const std::string& key) { return key == "elementdatafile"; });
  const std::string dimensions = header.field("ndims"), file = header.field("elementdatafile");
  if (dimensions.empty() || file.empty()) refuse(path, "not a MetaImage file (wrong magic)");
  if (dimensions != "3") refuse(path, "a 3-D image is needed (NDims = " + dimensions + ")");
  if (const std::string skip = header.field("headersize"); !skip.empty() && skip != "0")
    refuse(path, "'HeaderSize' is not supported");
  if (lower(header.field("binarydata")) == "false") refuse(path, "voxels written as text are not supported");
  for (const char* key : {"dimsize", "elementtype"})  // ITK prints what it misses
    if (header.field(key).empty()) refuse(path, std::string("the MetaImage header has no '") + key + "'");
  const bool is_compressed = lower(header.field("compresseddata")) == "true";
  const bool is_local = file == "LOCAL" || file == "Local" || file == "local";  // as ITK has it
  const VoxelData data{is_local ? path : beside(path, file), is_local ? header.bytes : 0, is_compressed};
  // ITK reads as many bytes as the header says, whatever the stream needs.
  const std::string stream_bytes = header.field("compresseddatasize");
  const std::uint64_t size = file_bytes(data.path);
  if (is_compressed && !stream_bytes.empty() &&
      stream_bytes != std::to_string(size - std::min(size, data.offset)))
    refuse(path,
           "the file is truncated (CompressedDataSize = " + stream_bytes + " is not the size of its stream)");
  return data;
}

void expect_voxel_bytes(const std::string& path, const VoxelData& data, std::uint64_t needed) {
  const std::uint64_t size = file_bytes(data.path);
  std::uint64_t found = size - std::min(size, data.offset);
  if (data.is_compressed && needed / kBestCompression <= found) {
    std::ifstream file(data.path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(data.offset));
    found = decompressed_bytes(path, file);
  }
  const std::string detail = " (its header announces " + std::to_string(needed) +
                             " bytes of voxels, it holds " + std::to_string(found) + ")";
  if (found < needed) refuse(path, "the file is truncated" + detail);
  if (found > needed) refuse(path, "the file holds more data than its header announces" + detail);
}

}  // namespace podm
