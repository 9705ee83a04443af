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
  // ITK takes a value as true by its first letter.
  bool flag(const std::string& key) const {
    const std::string text = field(key);
    return !text.empty() && std::string("tT1").find(text[0]) != std::string::npos;
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

// Reads lines "key SEPARATOR value" up to the line with key `last`, or to the end. An empty line has an empty
// key. `check(line, number)` is called for each line first, with numbers from 1.
template <class Check>
TextHeader read_text_header(const std::string& path, char separator, const std::string& last, Check check) {
  file_bytes(path);
  std::ifstream file(path, std::ios::binary);
  TextHeader header;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    header.bytes += line.size() + 1;
    if (header.bytes > kLongestHeader) refuse(path, "the header has no end");
    check(line, ++number);
    const std::size_t at = line.find(separator);
    const std::string key = trimmed(line.substr(0, at));
    if (at != std::string::npos && key[0] != '#') header.fields[lower(key)] = trimmed(line.substr(at + 1));
    if (key == last) break;
  }
  return header;
}

// ITK reports a line that it cannot parse, and the path, in a message buffer of a thousand bytes, whatever
// their length. It can parse any line of the form 'name:=value'.
constexpr std::size_t kLongestInMessage = 500;

void expect_nrrd_line(const std::string& path, const std::string& line, int number) {
  const std::size_t colon = line.find(':');
  const bool has_name = colon != std::string::npos && line.compare(colon, 2, ":=") == 0;
  const bool is_parsed = line.starts_with('#') || (number > 1 && has_name);
  if (line.size() > kLongestInMessage && !is_parsed)
    refuse(path, "line " + std::to_string(number) + " of the NRRD header is longer than " +
                     std::to_string(kLongestInMessage) + " bytes");
}

// ITK copies names and some values into 255 bytes, whatever their length. It takes the value of a name
// without '=' from the next line, even beyond the last line. It takes a carriage return inside a line as a
// part of the value, and then leaks the object that opens the file of that name.
void expect_meta_line(const std::string& path, const std::string& line, int number) {
  constexpr std::size_t kLongestLine = 254;
  const std::string place = "wrong magic or header (line " + std::to_string(number);
  if (line.size() > kLongestLine)
    refuse(path, place + " is longer than " + std::to_string(kLongestLine) + " bytes)");
  if (const std::size_t at = line.find('\r'); at != std::string::npos && at + 1 < line.size())
    refuse(path, place + " contains a carriage return)");
  const std::size_t at = line.find_first_of("=:");
  if (!trimmed(line).empty() && (at == std::string::npos || line[at] != '='))
    refuse(path, place + " is not of the form 'name = value')");
}

// The path of a file that is named in the header of `path`.
std::string beside(const std::string& path, const std::string& name) {
  const std::string data_path = (std::filesystem::path(path).parent_path() / name).string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(data_path, error))
    refuse(path, "its voxels are missing (no file '" + name + "' beside it)");
  return data_path;
}

// One zlib or gzip stream, from the beginning of the data.
class Inflater {
 public:
  Inflater(const std::string& path, const VoxelData& data)
      : path_(path), file_(data.path, std::ios::binary), stream_(new z_stream{}) {
    constexpr int kZlibOrGzip = 32 + MAX_WBITS;
    if (inflateInit2(stream_.get(), kZlibOrGzip) != Z_OK) refuse(path, "zlib cannot be initialised");
    file_.seekg(static_cast<std::streamoff>(data.offset));
  }

  // Returns the number of bytes put into `out`, which is less than `size` only at the end of the stream.
  std::size_t read(unsigned char* out, std::size_t size) {
    constexpr std::size_t kMostAtOnce = 1 << 30;  // zlib counts in int
    std::size_t made = 0;
    while (made < size && !is_at_end_) {
      const std::size_t room = std::min(size - made, kMostAtOnce);
      stream_->next_out = out + made;
      stream_->avail_out = static_cast<uInt>(room);
      inflate_some();
      made += room - stream_->avail_out;
    }
    return made;
  }
  std::uint64_t bytes_taken() const { return stream_->total_in; }

 private:
  struct End {
    void operator()(z_stream* stream) const {
      inflateEnd(stream);
      delete stream;
    }
  };

  void inflate_some() {
    if (stream_->avail_in == 0) {
      file_.read(reinterpret_cast<char*>(in_.data()), static_cast<std::streamsize>(in_.size()));
      stream_->next_in = in_.data();
      stream_->avail_in = static_cast<uInt>(file_.gcount());
      if (stream_->avail_in == 0) refuse(path_, "the file is truncated (its compressed voxels have no end)");
    }
    const int code = inflate(stream_.get(), Z_NO_FLUSH);
    is_at_end_ = code == Z_STREAM_END;
    if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
      refuse(path_, "the compressed voxels are damaged");
  }

  const std::string& path_;
  std::ifstream file_;
  std::unique_ptr<z_stream, End> stream_;
  std::array<unsigned char, 1 << 15> in_;
  bool is_at_end_ = false;
};

// Reads the rest of the stream and only counts it. A hostile stream therefore costs time but no memory.
std::uint64_t bytes_left(Inflater& stream) {
  std::vector<unsigned char> out(1 << 17);
  std::uint64_t total = 0;
  while (const std::size_t made = stream.read(out.data(), out.size())) total += made;
  return total;
}

void expect_bytes(const std::string& path, std::uint64_t found, std::uint64_t needed) {
  const std::string detail = " (its header announces " + std::to_string(needed) +
                             " bytes of voxels, it holds " + std::to_string(found) + ")";
  if (found < needed) refuse(path, "the file is truncated" + detail);
  if (found > needed) refuse(path, "the file holds more data than its header announces" + detail);
}

std::uint64_t bytes_in_file(const VoxelData& data) {
  const std::uint64_t size = file_bytes(data.path);
  return size - std::min(size, data.offset);
}

bool can_hold(std::uint64_t compressed_bytes, std::uint64_t needed) {
  return needed / kBestCompression <= compressed_bytes;
}

}  // namespace

VoxelData find_nrrd_voxels(const std::string& path) {
  if (path.size() > kLongestInMessage)
    refuse(path, "the path of a NRRD file is longer than " + std::to_string(kLongestInMessage) + " bytes");
  std::array<char, 4> magic{};
  std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
  file_bytes(path);
  if (std::string(magic.data(), magic.size()) != "NRRD") refuse(path, "not a NRRD file (wrong magic)");
  const TextHeader header = read_text_header(
      path, ':', "", [&](const std::string& line, int number) { expect_nrrd_line(path, line, number); });
  for (const char* key : {"line skip", "lineskip", "byte skip", "byteskip"})
    if (const std::string skip = header.field(key); !skip.empty() && skip != "0")
      refuse(path, std::string("'") + key + "' is not supported");
  const std::string encoding = lower(header.field("encoding"));
  const bool is_compressed = encoding == "gzip" || encoding == "gz";
  if (!is_compressed && encoding != "raw")
    refuse(path, "encoding '" + encoding + "' is not supported (raw and gzip are)");
  const std::string file = header.field("data file") + header.field("datafile");
  const bool is_big_endian = lower(header.field("endian")) == "big";
  if (file.empty()) return {path, header.bytes, is_compressed, is_big_endian};
  return {beside(path, file), 0, is_compressed, is_big_endian};
}

VoxelData find_meta_voxels(const std::string& path) {
  const TextHeader header =
      read_text_header(path, '=', "ElementDataFile",
                       [&](const std::string& line, int number) { expect_meta_line(path, line, number); });
  const std::string dimensions = header.field("ndims"), file = header.field("elementdatafile");
  if (dimensions.empty() || file.empty()) refuse(path, "not a MetaImage file (wrong magic)");
  if (dimensions != "3") refuse(path, "a 3-D image is needed (NDims = " + dimensions + ")");
  if (const std::string skip = header.field("headersize"); !skip.empty() && skip != "0")
    refuse(path, "'HeaderSize' is not supported");
  if (lower(header.field("binarydata")) == "false") refuse(path, "voxels written as text are not supported");
  for (const char* key : {"dimsize", "elementtype"})  // ITK prints a message if one is missing
    if (header.field(key).empty()) refuse(path, std::string("the MetaImage header has no '") + key + "'");
  const bool is_local =
      file == "LOCAL" || file == "Local" || file == "local";  // the spellings that ITK accepts
  return {is_local ? path : beside(path, file), is_local ? header.bytes : 0, header.flag("compresseddata"),
          header.flag("binarydatabyteordermsb") || header.flag("elementbyteordermsb"),
          header.field("compresseddatasize")};
}

void expect_voxel_bytes(const std::string& path, const VoxelData& data, std::uint64_t needed) {
  std::uint64_t found = bytes_in_file(data);
  if (data.is_compressed && can_hold(found, needed)) {
    Inflater stream(path, data);
    found = bytes_left(stream);
  }
  expect_bytes(path, found, needed);
}

std::vector<unsigned char> decompressed_voxels(const std::string& path, const VoxelData& data,
                                               std::uint64_t needed, std::vector<std::string>& warnings) {
  if (const std::uint64_t in_file = bytes_in_file(data); !can_hold(in_file, needed))
    expect_bytes(path, in_file, needed);
  std::vector<unsigned char> voxels(needed);
  Inflater stream(path, data);
  const std::size_t made = stream.read(voxels.data(), needed);
  expect_bytes(path, made + bytes_left(stream), needed);
  const std::string taken = std::to_string(stream.bytes_taken());
  if (!data.announced_bytes.empty() && data.announced_bytes != taken)
    warnings.push_back(path + ": CompressedDataSize is " + data.announced_bytes + ", but the stream has " +
                       taken + " bytes; the stream is complete and was read to its end");
  return voxels;
}

}  // namespace podm
