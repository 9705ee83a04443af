// Decodes the numbers of a VTU array. Binary data begin with a header. Without compression it is the number
// of bytes. With compression it is the number of blocks, the size of a block, the size of the last block if
// that differs, and the compressed sizes.
#include <fmt/format.h>
#include <zlib.h>

#include <cstring>

#include "readers/cursor.h"
#include "readers/vtu_bytes.h"
#include "readers/vtu_document.h"

namespace podm::verify {
namespace {

constexpr std::uint64_t kBestRatio = 1032;  // deflate's best ratio

class ArrayLoader {
 public:
  ArrayLoader(const MeshFile& file, VtuDocument& document, const VtuArray& array)
      : file_(file), document_(document), array_(array) {}

  NumberArray load() {
    if (array_.format == VtuArray::Format::kAscii) return load_ascii();
    const bool is_appended = array_.format == VtuArray::Format::kAppended;
    if (!is_appended && array_.end == 0) return {std::string_view(), array_.type, false};  // no text at all
    VtuBytes source = is_appended ? appended() : VtuBytes(file_, array_.begin, array_.end, true);
    const std::size_t begin = source.position();
    NumberArray values = document_.is_zlib ? load_zlib(source) : load_plain(source);
    if (is_appended) count_appended(source.position() - begin);
    return values;
  }

 private:
  // Numbers get the type that the file declares, so 0.1 as Float32 is the same in text and in binary.
  NumberArray load_ascii() const {
    Cursor cursor(file_, array_.begin, array_.end);
    ByteBuffer bytes;
    with_number_type(array_.type, [&](auto type) {
      using Number = decltype(type);
      while (!cursor.is_at_last_word()) {
        const auto value = cursor.number<Number>("a value of the array");
        std::memcpy(bytes.extend(sizeof(Number)), &value, sizeof(Number));
      }
    });
    return {std::move(bytes), array_.type, false};
  }

  VtuBytes appended() const {
    const std::size_t size = file_.bytes().size();
    if (!document_.appended_begin) refuse("format is appended, the file has no AppendedData");
    if (array_.begin > size - *document_.appended_begin) {
      refuse(fmt::format("offset {} lies outside the file ({} bytes of appended data)", array_.begin,
                         size - *document_.appended_begin));
    }
    return {file_, *document_.appended_begin + array_.begin, size, document_.is_appended_base64};
  }

  void count_appended(std::uint64_t num_bytes) {
    document_.appended_bytes_loaded += num_bytes;
    if (document_.appended_bytes_loaded > file_.bytes().size() - *document_.appended_begin)
      refuse("it overlaps other arrays of the appended data");
  }

  bool is_swapped() const { return document_.is_big_endian; }

  std::uint64_t header_number(VtuBytes& source) const {
    ByteBuffer bytes;
    if (document_.has_wide_headers)
      return load_number<std::uint64_t>(source.take(8, bytes).data(), is_swapped());
    return load_number<std::uint32_t>(source.take(4, bytes).data(), is_swapped());
  }

  NumberArray load_plain(VtuBytes& source) const {
    const std::size_t place = source.position();
    const std::uint64_t size = header_number(source);
    if (size > source.most_left()) {
      refuse(fmt::format("{} bytes are announced at byte {}, at most {} are left", size, place,
                         source.most_left()));
    }
    ByteBuffer bytes;
    const std::string_view view = source.take(size, bytes);
    check_whole(size);
    if (bytes.size() == 0) return {view, array_.type, is_swapped()};
    return {std::move(bytes), array_.type, is_swapped()};
  }

  NumberArray load_zlib(VtuBytes& source) const {
    const std::uint64_t num_blocks = header_number(source), block_size = header_number(source),
                        last_size = header_number(source);
    if (num_blocks > source.most_left() / (document_.has_wide_headers ? 8 : 4))
      refuse(fmt::format("{} compressed blocks are announced, the file cannot hold that many", num_blocks));
    std::vector<std::uint64_t> compressed_sizes;
    for (std::uint64_t i = 0; i < num_blocks; ++i) compressed_sizes.push_back(header_number(source));
    ByteBuffer bytes;
    for (std::uint64_t i = 0; i < num_blocks; ++i) {
      const bool is_short = i + 1 == num_blocks && last_size != 0;
      inflate_block(source, i, compressed_sizes[i], is_short ? last_size : block_size, bytes);
    }
    check_whole(bytes.size());
    return {std::move(bytes), array_.type, is_swapped()};
  }

  void inflate_block(VtuBytes& source, std::uint64_t block, std::uint64_t compressed_size, std::uint64_t size,
                     ByteBuffer& bytes) const {
    const std::size_t place = source.position();
    ByteBuffer decoded;
    const std::string_view compressed = source.take(compressed_size, decoded);
    uLongf inflated_size = size;
    const bool is_possible = size / kBestRatio <= compressed_size;
    const int code = is_possible
                         ? uncompress(reinterpret_cast<Bytef*>(bytes.extend(size)), &inflated_size,
                                      reinterpret_cast<const Bytef*>(compressed.data()), compressed_size)
                         : Z_DATA_ERROR;
    if (code != Z_OK || inflated_size != size) {
      refuse(fmt::format("compressed block {} at byte {} is damaged or not of the {} bytes announced", block,
                         place, size));
    }
  }

  void check_whole(std::uint64_t size) const {
    if (size % size_of(array_.type) != 0)
      refuse(fmt::format("{} bytes are not a whole number of values", size));
  }

  [[noreturn]] void refuse(const std::string& fault) const { file_.refuse(array_.place(), fault); }

  const MeshFile& file_;
  VtuDocument& document_;
  const VtuArray& array_;
};

}  // namespace

NumberArray load_vtu_array(const MeshFile& file, VtuDocument& document, const VtuArray& array,
                           std::optional<std::uint64_t> count) {
  NumberArray values = ArrayLoader(file, document, array).load();
  if (count && values.size() != *count)
    file.refuse(array.place(), fmt::format("{} values, {} are expected", values.size(), *count));
  return values;
}

}  // namespace podm::verify
