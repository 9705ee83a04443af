// expat parses the XML in chunks. The parser records where the text of an array is and does not copy it. It
// stops at appended data, which need not be XML. Format: VTK file formats, "XML file formats".
#include "readers/vtu_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "readers/mesh_parts.h"
#include "readers/xml_parser.h"

namespace podm::verify {
namespace {

constexpr std::size_t kChunkBytes = 1 << 18, kLongestTag = 1 << 20;
constexpr std::size_t kDeepest = 32;

struct TypeName {
  std::string_view name;
  NumberType type;
};
constexpr TypeName kTypes[] = {
    {"Int8", NumberType::kInt8},       {"UInt8", NumberType::kUInt8},   {"Int16", NumberType::kInt16},
    {"UInt16", NumberType::kUInt16},   {"Int32", NumberType::kInt32},   {"UInt32", NumberType::kUInt32},
    {"Int64", NumberType::kInt64},     {"UInt64", NumberType::kUInt64}, {"Float32", NumberType::kFloat32},
    {"Float64", NumberType::kFloat64},
};

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == std::string_view::npos; }

class VtuParser : XmlParser {
 public:
  explicit VtuParser(const MeshFile& file) : XmlParser(file, "VTU") {}

  VtuDocument parse() {
    const std::string_view bytes = file_.bytes();
    for (std::size_t begin = 0; begin < bytes.size() && !document_.appended_begin; begin += kChunkBytes) {
      const std::string_view chunk = bytes.substr(begin, kChunkBytes);
      const std::size_t end = begin + chunk.size();
      parse_part(chunk, end == bytes.size());
      if (end - position() > kLongestTag && !document_.appended_begin)
        refuse(fmt::format("a tag of more than {} bytes", kLongestTag));
    }
    check_end();
    return std::move(document_);
  }

 private:
  void on_start(std::string_view name) override {
    if (elements_.size() >= kDeepest) refuse("elements nest too deep");
    if (elements_.empty() && name != "VTKFile") refuse("the root element is not VTKFile");
    if (array_ != nullptr) end_text();
    elements_.emplace_back(name);
    if (name == "VTKFile") {
      on_file();
    } else if (name == "Piece") {
      document_.pieces.push_back({line(), number("NumberOfPoints"), number("NumberOfCells"), {}, {}, {}, {}});
    } else if (name == "DataArray" || name == "Array") {
      on_array();
    } else if (name == "AppendedData") {
      on_appended_data();
    }
    text_begin_ = after_tag();
  }

  void on_end() override {
    if (array_ != nullptr) end_text();
    if (array_depth_ == elements_.size()) array_ = nullptr;
    elements_.pop_back();
    text_begin_ = after_tag();
  }

  void on_file() {
    if (attribute("type") != "UnstructuredGrid")
      refuse(fmt::format("VTKFile of type '{}', not UnstructuredGrid", attribute("type")));
    const std::string_view order = attribute("byte_order"), header = attribute("header_type"),
                           compressor = attribute("compressor");
    if (!order.empty() && order != "LittleEndian" && order != "BigEndian")
      refuse(fmt::format("byte_order '{}' is not known", order));
    document_.is_big_endian = order == "BigEndian";
    if (!header.empty() && header != "UInt32" && header != "UInt64")
      refuse(fmt::format("header_type '{}' is neither UInt32 nor UInt64", header));
    document_.has_wide_headers = header == "UInt64";
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      refuse(fmt::format("compressor '{}' is not supported, only vtkZLibDataCompressor is", compressor));
    document_.is_zlib = !compressor.empty();
  }

  // Returns the list for an array of the current section; null if no array of that name is needed.
  std::vector<VtuArray>* list_of(const std::string& name) {
    if (elements_.size() < 2) return nullptr;
    const std::string& section = elements_[elements_.size() - 2];
    if (section == "FieldData")
      return name.starts_with("space:") || name.starts_with("label:") || name.starts_with("promise:") ||
                     name == kColourArray
                 ? &document_.field_data
                 : nullptr;
    if (document_.pieces.empty()) return nullptr;
    VtuPiece& piece = document_.pieces.back();
    if (section == "Points") return &piece.points;
    if (section == "Cells") return &piece.cells;
    if (section == "CellData") return is_kept_cell_array(name) ? &piece.cell_data : nullptr;
    if (section == "PointData") return name == "vertex" || name == kGlobalIds ? &piece.point_data : nullptr;
    return nullptr;
  }

  void on_array() {
    if (array_ != nullptr) refuse("an array within an array");
    VtuArray array;
    array.name = attribute("Name");
    std::vector<VtuArray>* list = list_of(array.name);
    const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                    [&](const TypeName& t) { return t.name == attribute("type"); });
    if (list == nullptr || attribute("type") == "String" || attribute("type") == "Bit") return;  // no labels
    array.line = line();
    if (type == std::end(kTypes))
      refuse(
          fmt::format("DataArray '{}' of type '{}': not a type of numbers", array.name, attribute("type")));
    array.type = type->type;
    if (!attribute("NumberOfComponents").empty()) array.num_components = number("NumberOfComponents");
    const std::string_view format = attribute("format");
    if (format == "appended") {
      array.format = VtuArray::Format::kAppended;
      array.begin = number("offset");
    } else if (format == "binary") {
      array.format = VtuArray::Format::kInlineBase64;
    } else if (!format.empty() && format != "ascii") {
      refuse(fmt::format("DataArray '{}': format '{}' is not known", array.name, format));
    }
    list->push_back(std::move(array));
    array_ = &list->back();
    array_depth_ = elements_.size();
  }

  // Records the text of the array between two tags. Text in child elements (VTK's InformationKey) is not part
  // of the array.
  void end_text() {
    const bool is_own = elements_.size() == array_depth_ && array_->format != VtuArray::Format::kAppended;
    if (!is_own || position() <= text_begin_) return;
    if (is_blank(file_.bytes().substr(text_begin_, position() - text_begin_))) return;
    if (array_->end != 0) refuse(fmt::format("DataArray '{}': its text is in several parts", array_->name));
    array_->begin = text_begin_;
    array_->end = position();
  }

  void on_appended_data() {
    const std::string_view encoding = attribute("encoding");
    if (encoding != "raw" && encoding != "base64")
      refuse(fmt::format("AppendedData: encoding '{}' is neither raw nor base64", encoding));
    document_.is_appended_base64 = encoding == "base64";
    const std::string_view bytes = file_.bytes();
    const std::size_t mark = bytes.find_first_not_of(" \t\r\n", after_tag());
    if (mark == std::string_view::npos || bytes[mark] != '_') refuse("AppendedData does not begin with '_'");
    document_.appended_begin = mark + 1;
    stop();
  }

  // No parser reads beyond appended data; the last tag shows if a file was cut off.
  void check_end() const {
    const std::string_view bytes = file_.bytes();
    constexpr std::string_view kLastTag = "</VTKFile>";
    const std::size_t last = bytes.find_last_not_of(std::string_view(" \t\r\n\0", 5));
    if (!bytes.substr(0, last + 1).ends_with(kLastTag))
      file_.refuse(MeshFile::byte_at(bytes.size()), fmt::format("the file does not end with {}", kLastTag));
  }

  std::uint64_t number(const char* name) const {
    const std::string_view text = attribute(name);
    std::uint64_t value = 0;
    const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || after != text.data() + text.size())
      refuse(fmt::format("{}: {}=\"{}\" is not a count", elements_.back(), name, text.substr(0, 40)));
    return value;
  }

  VtuDocument document_;
  std::vector<std::string> elements_;  // open elements, outermost first
  VtuArray* array_ = nullptr;          // open array that is kept
  std::size_t array_depth_ = 0;
  std::size_t text_begin_ = 0;
};

}  // namespace

std::string VtuArray::place() const { return fmt::format("line {}, DataArray '{}'", line, name); }

VtuDocument parse_vtu(const MeshFile& file) { return VtuParser(file).parse(); }

}  // namespace podm::verify
