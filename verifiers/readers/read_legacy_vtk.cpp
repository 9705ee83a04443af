// Legacy VTK files (.vtk) with an unstructured grid: ASCII and BINARY (big endian), cells as lists (versions
// before 5) or as OFFSETS and CONNECTIVITY. Format: VTK file formats, "Simple legacy formats".
//
// podm's files have field data of the data set, as its VTU files do, with VTK's percent code in names.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "readers/cursor.h"
#include "readers/formats.h"
#include "readers/mesh_parts.h"
#include "readers/vtk_cells.h"
#include "readers/vtu_grid.h"

namespace podm::verify {
namespace {

// VTK writes ids of type vtkIdType as int.
std::optional<NumberType> number_type(const std::string& upper_name) {
  static const std::pair<const char*, NumberType> kTypes[] = {
      {"CHAR", NumberType::kInt8},
      {"SIGNED_CHAR", NumberType::kInt8},
      {"UNSIGNED_CHAR", NumberType::kUInt8},
      {"SHORT", NumberType::kInt16},
      {"UNSIGNED_SHORT", NumberType::kUInt16},
      {"INT", NumberType::kInt32},
      {"UNSIGNED_INT", NumberType::kUInt32},
      {"LONG", NumberType::kInt64},
      {"UNSIGNED_LONG", NumberType::kUInt64},
      {"FLOAT", NumberType::kFloat32},
      {"DOUBLE", NumberType::kFloat64},
      {"VTKIDTYPE", NumberType::kInt32},
      {"VTKTYPEINT64", NumberType::kInt64},
      {"VTKTYPEUINT64", NumberType::kUInt64},
  };
  for (const auto& [name, type] : kTypes)
    if (upper_name == name) return type;
  return std::nullopt;
}

// VTK encodes characters that an array name may not contain as '%' and two hexadecimal digits.
std::string percent_decoded(const std::string& name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = name.data() + i + 1;
    const bool is_code = name[i] == '%' && i + 2 < name.size() &&
                         std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    text += is_code ? static_cast<char>(byte) : name[i];
    if (is_code) i += 2;
  }
  return text;
}

class LegacyVtkReader {
 public:
  /// `id_array` has the same meaning as in read_vtu_grid().
  LegacyVtkReader(const MeshFile& file, const char* id_array)
      : file_(file), id_array_(id_array), cursor_(file) {}

  VtuGrid read() {
    read_head();
    while (!cursor_.is_at_last_word()) {
      const std::string keyword = upper(cursor_.word("a keyword"));
      if (!read_geometry(keyword) && !read_attribute(keyword))
        cursor_.refuse_word("is not a keyword", keyword);
    }
    return assemble();
  }

 private:
  void read_head() {
    const auto version = after_prefix(cursor_.rest_of_line(), "# vtk DataFile Version ");
    if (!version || version->empty()) cursor_.refuse("not a legacy VTK file: no '# vtk DataFile Version'");
    version_ = *version;
    has_offsets_ = version_[0] >= '5';
    cursor_.rest_of_line();  // title
    const std::string coding = upper(cursor_.word("ASCII or BINARY"));
    if (coding != "ASCII" && coding != "BINARY") cursor_.refuse("neither ASCII nor BINARY");
    is_binary_ = coding == "BINARY";
    if (is_binary_) cursor_.name_bytes();
    if (upper(cursor_.word("DATASET")) != "DATASET") cursor_.refuse("no DATASET");
    if (upper(cursor_.word("the kind of data")) != "UNSTRUCTURED_GRID")
      cursor_.refuse("the data set is not an UNSTRUCTURED_GRID");
  }

  bool read_geometry(const std::string& keyword) {
    if (keyword == "POINTS") {
      const std::size_t count = read_count("the number of points");
      piece_.points = read_array(cursor_.word("the type of points"), count, 3);
      has_points_ = true;
    } else if (keyword == "CELLS") {
      read_cells();
    } else if (keyword == "CELL_TYPES") {
      const std::size_t count = read_count("the number of cell types");
      piece_.types = read_numbers(NumberType::kInt32, count, 1);
    } else if (keyword == "CELL_DATA" || keyword == "POINT_DATA") {
      num_tuples_ = read_count("the number of tuples");
      is_cell_data_ = keyword == "CELL_DATA";
      is_field_data_ = false;
      if (is_cell_data_ && num_tuples_ != num_cells_)
        cursor_.refuse(fmt::format("CELL_DATA of {} cells, the grid has {}", num_tuples_, num_cells_));
    } else if (keyword == "METADATA") {
      cursor_.rest_of_line();
      while (!cursor_.is_at_end() && !cursor_.rest_of_line().empty()) {
      }
    } else {
      return false;
    }
    return true;
  }

  void read_cells() {
    const std::size_t count = read_count("the number of cells"), size = read_count("the size of the cells");
    has_cells_ = true;
    num_cells_ = has_offsets_ ? std::max<std::size_t>(count, 1) - 1 : count;  // one offset more than cells
    if (!has_offsets_) {
      piece_.layout = CellLayout::kInterleaved;
      piece_.connectivity = read_numbers(NumberType::kInt32, size, 1);
      return;
    }
    piece_.layout = CellLayout::kStarts;
    expect_word("OFFSETS");
    piece_.offsets = read_array(cursor_.word("the type of OFFSETS"), count, 1);
    expect_word("CONNECTIVITY");
    piece_.connectivity = read_array(cursor_.word("the type of CONNECTIVITY"), size, 1);
  }

  bool read_attribute(const std::string& keyword) {
    if (keyword == "FIELD") return read_field();
    if (keyword == "SCALARS") return read_scalars();
    if (keyword == "LOOKUP_TABLE" || keyword == "COLOR_SCALARS") return skip_colors(keyword);
    if (keyword == "TEXTURE_COORDINATES") {
      cursor_.word("a name");
      const std::size_t dimension = read_count("a dimension");
      read_array(cursor_.word("a type"), num_tuples_, dimension);
      return true;
    }
    static const std::pair<const char*, std::size_t> kComponents[] = {
        {"VECTORS", 3},    {"NORMALS", 3},      {"TENSORS", 9},   {"TENSORS6", 6},
        {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1}};
    for (const auto& [name, num_components] : kComponents) {
      if (keyword != name) continue;
      cursor_.word("a name");
      read_array(cursor_.word("a type"), num_tuples_, num_components);
      return true;
    }
    return false;
  }

  bool read_scalars() {
    const std::string name(cursor_.word("a name"));
    const std::string type(cursor_.word("a type"));
    const std::size_t num_components = cursor_.is_at_end_of_line() ? 1 : read_count("the components");
    if (is_binary_ || upper(cursor_.peek_word()) == "LOOKUP_TABLE") {
      expect_word("LOOKUP_TABLE");
      cursor_.word("the name of a lookup table");
    }
    keep(name, num_components, read_array(type, num_tuples_, num_components));
    return true;
  }

  bool skip_colors(const std::string& keyword) {
    cursor_.word("a name");
    const std::size_t count = read_count("a number of colours");
    const std::size_t num_tuples = keyword == "LOOKUP_TABLE" ? count : num_tuples_;
    read_numbers(is_binary_ ? NumberType::kUInt8 : NumberType::kFloat32, num_tuples,
                 keyword == "LOOKUP_TABLE" ? 4 : count);
    return true;
  }

  bool read_field() {
    cursor_.word("a name");
    const std::size_t num_arrays = read_count("the number of arrays");
    for (std::size_t i = 0; i < num_arrays; ++i) {
      std::string name(cursor_.word("the name of an array"));
      if (upper(name) == "METADATA") {  // belongs to the array before
        read_geometry("METADATA");
        name = cursor_.word("the name of an array");
      }
      const std::size_t num_components = read_count("the components"), num_tuples = read_count("the tuples");
      keep(name, num_components,
           read_array(cursor_.word("the type of an array"), num_tuples, num_components));
    }
    return true;
  }

  void keep(const std::string& name, std::size_t num_components, NumberArray values) {
    if (is_field_data_) return read_word(percent_decoded(name), values);
    if (is_cell_data_ && is_kept_cell_array(name))
      piece_.cell_data.push_back({name, num_components, std::move(values)});
    if (!is_cell_data_ && id_array_ != nullptr && name == id_array_) keep_ids(values);
  }

  // Reads the same words as in podm's VTU files.
  void read_word(const std::string& name, const NumberArray& values) {
    if (read_note(file_, "FIELD", name, grid_.mesh, ':')) return;
    if (const auto label = after_prefix(name, "label:")) {
      const auto value = values.size() == 1 ? values.integer(0) : std::nullopt;
      if (!value) cursor_.refuse("not one integer, the value of the label");
      grid_.mesh.label_names[*value] = *label;
    } else if (name == kColourArray) {
      read_label_colours(file_, "FIELD", values, grid_.mesh);
    }
  }

  void keep_ids(const NumberArray& ids) {
    grid_.point_ids.clear();
    for (std::size_t i = 0; i < ids.size(); ++i) grid_.point_ids.push_back(global_id(ids.integer(i)));
  }

  // Any count is accepted that the rest of the file could hold at one byte each; reading the numbers checks
  // the rest.
  std::size_t read_count(const char* what) { return cursor_.count(what, 1); }

  void expect_word(const char* keyword) {
    if (upper(cursor_.word(keyword)) != keyword) cursor_.refuse(fmt::format("no {} here", keyword));
  }

  NumberArray read_array(std::string_view type_name, std::size_t count, std::size_t num_components) {
    const std::string name = upper(type_name);
    if (name == "STRING") return skip_strings(count, num_components);
    if (name == "BIT") return skip_bits(count, num_components);
    const auto type = number_type(name);
    if (!type) cursor_.refuse_word("is not a type", name);
    return read_numbers(*type, count, num_components);
  }

  std::size_t product(std::size_t count, std::size_t num_components, std::size_t values_per_byte = 1) const {
    if (num_components == 0) return 0;
    cursor_.expect_room(count / values_per_byte, num_components, "the number of tuples");
    return count * num_components;
  }

  NumberArray read_numbers(NumberType type, std::size_t count, std::size_t num_components) {
    const std::size_t num_values = product(count, num_components);
    if (is_binary_) {
      cursor_.rest_of_line();
      return {cursor_.raw(std::uint64_t{num_values} * size_of(type), "an array"), type, true};
    }
    ByteBuffer bytes;
    with_number_type(type, [&](auto number) {
      using Number = decltype(number);
      for (std::size_t i = 0; i < num_values; ++i) {
        number = cursor_.number<Number>("a value of an array");
        std::memcpy(bytes.extend(sizeof(Number)), &number, sizeof(Number));
      }
    });
    return {std::move(bytes), type, false};
  }

  NumberArray skip_bits(std::size_t count, std::size_t num_components) {
    return is_binary_ ? read_numbers(NumberType::kUInt8, (product(count, num_components, 8) + 7) / 8, 1)
                      : read_numbers(NumberType::kUInt8, count, num_components);
  }

  // In ASCII a string is a line. In BINARY its length comes first, in 1, 2, 4 or 8 bytes, as two bits state.
  NumberArray skip_strings(std::size_t count, std::size_t num_components) {
    const std::size_t num_values = product(count, num_components);
    cursor_.rest_of_line();
    for (std::size_t i = 0; i < num_values; ++i) {
      if (!is_binary_) {
        if (cursor_.is_at_end()) cursor_.refuse("the file ends within an array of strings");
        cursor_.rest_of_line();
        continue;
      }
      const auto first = cursor_.raw_number<std::uint8_t>(false, "the length of a string");
      constexpr std::size_t kMoreBytes[] = {7, 3, 1, 0};
      std::uint64_t length = first & 0x3f;
      for (std::size_t more = kMoreBytes[first >> 6]; more > 0; --more)
        length = length << 8 | cursor_.raw_number<std::uint8_t>(false, "the length of a string");
      cursor_.raw(length, "a string");
    }
    return {};
  }

  VtuGrid assemble() {
    Mesh& mesh = grid_.mesh;
    mesh.format = fmt::format("legacy VTK {}, {}", version_.substr(0, 8), is_binary_ ? "binary" : "ascii");
    piece_.place = "UNSTRUCTURED_GRID";
    if (!has_points_ || !has_cells_) file_.refuse(piece_.place, has_points_ ? "no CELLS" : "no POINTS");
    if (piece_.types.size() != num_cells_) {
      file_.refuse(piece_.place,
                   fmt::format("CELL_TYPES names {} cells, CELLS {}", piece_.types.size(), num_cells_));
    }
    VtkAssembler(file_, mesh).append(piece_, true);
    if (id_array_ != nullptr) check_ids();
    return std::move(grid_);
  }

  void check_ids() {
    grid_.ids_place = fmt::format("POINT_DATA '{}'", id_array_);
    if (grid_.point_ids.size() != grid_.mesh.vertices.size())
      file_.refuse(grid_.ids_place, fmt::format("{} values, {} are expected", grid_.point_ids.size(),
                                                grid_.mesh.vertices.size()));
  }

  const MeshFile& file_;
  const char* id_array_;
  Cursor cursor_;
  VtuGrid grid_;
  std::string version_;
  bool is_binary_ = false, has_offsets_ = false;
  bool is_field_data_ = true;  // of the data set: before data of cells and points
  bool is_cell_data_ = false, has_points_ = false, has_cells_ = false;
  std::size_t num_cells_ = 0;
  std::size_t num_tuples_ = 0;  // of the current CELL_DATA or POINT_DATA
  VtkPiece piece_;
};

}  // namespace

Mesh read_legacy_vtk(const MeshFile& file) { return LegacyVtkReader(file, nullptr).read().mesh; }

void read_legacy_vtk_facets(const MeshFile& file, Mesh& mesh) {
  const VtuGrid surface = LegacyVtkReader(file, "vertex").read();
  check_points(file, surface, mesh);
  append_facets(file, surface, vertex_ids(surface), mesh);
}

}  // namespace podm::verify
