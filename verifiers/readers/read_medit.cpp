// Medit meshes: .mesh (text) and .meshb (the Gamma Mesh Format, versions 1 to 4, either byte order).
//
// Reals have 4 bytes in version 1, otherwise 8. Positions have 8 bytes from version 3 on, otherwise 4.
// Integers and counts have 8 bytes in version 4, otherwise 4. A section is a keyword, in .meshb the position
// of the next keyword, a count, and that number of lines. Ids are 1-based. podm's comments give the space,
// the labels' names and the pair of labels for each reference of a triangle.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "readers/cursor.h"
#include "readers/formats.h"
#include "readers/mesh_parts.h"

namespace podm::verify {
namespace {

struct Section {
  const char* keyword;
  std::int32_t code;       // in .meshb
  std::size_t num_ids;     // per line, before its reference
  const char* other_cell;  // name it is counted under; null for plain tetrahedra and triangles
};
constexpr Section kVertices{"Vertices", 4, 0, nullptr};
constexpr Section kCells[] = {
    {"Triangles", 6, 3, nullptr},
    {"Tetrahedra", 8, 4, nullptr},
    {"TrianglesP2", 24, 6, kQuadraticTriangles},
    {"TetrahedraP2", 30, 10, kQuadraticTetrahedra},
};
constexpr Section kOtherCells[] = {
    {"Edges", 5, 2, "lines"},        {"Quadrilaterals", 7, 4, "quadrilaterals"},
    {"Prisms", 9, 6, "wedges"},      {"Hexahedra", 10, 8, "hexahedra"},
    {"Pyramids", 49, 5, "pyramids"},
};
constexpr std::int32_t kDimensionCode = 3, kEndCode = 54;

// TextNumbers and BinaryNumbers read numbers. count() reads a number of lines with `num_numbers` numbers
// each.
class TextNumbers {
 public:
  explicit TextNumbers(Cursor& cursor) : cursor_(cursor) {}
  std::int64_t integer(const char* what) { return cursor_.number<std::int64_t>(what); }
  double real(const char* what) { return cursor_.number<double>(what); }
  std::size_t count(const char* what, std::size_t num_numbers) {
    return cursor_.count(what, 2 * num_numbers);
  }

 private:
  Cursor& cursor_;
};

class BinaryNumbers {
 public:
  BinaryNumbers(Cursor& cursor, std::int32_t version, bool is_swapped)
      : cursor_(cursor), version_(version), is_swapped_(is_swapped) {}
  std::int64_t integer(const char* what) { return version_ == 4 ? raw<std::int64_t>(what) : int32(what); }
  double real(const char* what) { return version_ == 1 ? double{raw<float>(what)} : raw<double>(what); }
  std::int32_t int32(const char* what) { return raw<std::int32_t>(what); }
  std::int64_t position(const char* what) { return version_ >= 3 ? raw<std::int64_t>(what) : int32(what); }
  std::size_t count(const char* what, std::size_t num_numbers) {
    const std::int64_t count = integer(what);
    if (count < 0) cursor_.refuse(fmt::format("{} is negative ({})", what, count));
    cursor_.expect_room(static_cast<std::uint64_t>(count), 4 * num_numbers, what);
    return static_cast<std::size_t>(count);
  }

 private:
  template <class Number>
  Number raw(const char* what) {
    return cursor_.raw_number<Number>(is_swapped_, what);
  }
  Cursor& cursor_;
  std::int32_t version_;
  bool is_swapped_;
};

class MeditBuilder {
 public:
  explicit MeditBuilder(const MeshFile& file) : file_(file) {}

  void read_comment(std::string_view text) { verify::read_comment(file_, text, mesh_, facet_groups_); }

  template <class Numbers>
  void read_vertices(Numbers numbers) {
    const std::size_t count = numbers.count("the number of vertices", 4);
    check_counts(file_, kVertices.keyword, mesh_.vertices.size() + count, 0);
    make_room(mesh_.vertices, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers.real("a coordinate"), y = numbers.real("a coordinate"),
                   z = numbers.real("a coordinate");
      mesh_.vertices.push_back({x, y, z});
      numbers.integer("the reference of a vertex");
    }
    has_vertices_ = true;
  }

  template <class Numbers>
  void read_cells(const Section& section, Numbers numbers) {
    const std::size_t count = numbers.count("the number of cells", section.num_ids + 1);
    check_counts(file_, section.keyword, 0, mesh_.cells.size() + count);
    const bool is_solid = section.num_ids == 4 || section.num_ids == 10;
    if (is_solid) {
      make_room(mesh_.cells, count);
      make_room(mesh_.cell_labels, count);
    }
    if (section.other_cell != nullptr && count > 0) mesh_.other_cells[section.other_cell] += count;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<VertexId, 10> ids;
      for (std::size_t k = 0; k < section.num_ids; ++k) ids[k] = id_of(numbers.integer("a vertex of a cell"));
      const std::int64_t reference = numbers.integer("the reference of a cell");
      if (is_solid) {
        mesh_.cells.push_back({ids[0], ids[1], ids[2], ids[3]});
        mesh_.cell_labels.push_back(reference);
      } else {
        mesh_.facets.push_back({ids[0], ids[1], ids[2]});
        facet_references_.push_back(reference);
      }
    }
  }

  template <class Numbers>
  void count_other_cells(const Section& section, Numbers numbers) {
    const std::size_t count = numbers.count("the number of cells", section.num_ids + 1);
    if (count > 0) mesh_.other_cells[section.other_cell] += count;
  }

  Mesh take(std::string format) {
    if (!has_vertices_) file_.refuse(kVertices.keyword, "the file has no such section");
    mesh_.format = std::move(format);
    if (!mesh_.cells.empty()) mesh_.cell_label_array = "medit:ref";
    if (!facet_groups_.empty())
      label_facets(file_, "Triangles", "reference", facet_references_, facet_groups_, mesh_);
    return std::move(mesh_);
  }

 private:
  static VertexId id_of(std::int64_t number) { return number > 0 ? vertex_id(number - 1) : kNone; }

  const MeshFile& file_;
  Mesh mesh_;
  bool has_vertices_ = false;
  std::vector<std::int64_t> facet_references_;
  FacetGroups facet_groups_;
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// True if a word that is no known keyword belongs to the section before it.
bool is_content(std::string_view word) {
  return !word.empty() &&
         (!is_letter(word[0]) || word == "nan" || word == "NaN" || word == "inf" || word == "Inf");
}

class MeditTextReader {
 public:
  explicit MeditTextReader(const MeshFile& file) : cursor_(file), builder_(file) {
    cursor_.skip_comments([this](std::string_view text) { builder_.read_comment(text); });
  }

  Mesh read() {
    if (cursor_.word("MeshVersionFormatted") != "MeshVersionFormatted")
      cursor_.refuse("the file does not begin with MeshVersionFormatted");
    cursor_.number<std::int32_t>("the version");
    while (true) {
      const std::string_view keyword = cursor_.word("End or another keyword");
      if (keyword == "End") break;
      read_section(keyword);
    }
    return builder_.take("Medit, ascii");
  }

 private:
  void read_section(std::string_view keyword) {
    const TextNumbers numbers(cursor_);
    if (keyword == "Dimension") {
      if (cursor_.number<std::int32_t>("the dimension") != 3) cursor_.refuse("the dimension is not 3");
      return;
    }
    if (keyword == kVertices.keyword) return builder_.read_vertices(numbers);
    for (const Section& section : kCells)
      if (keyword == section.keyword) return builder_.read_cells(section, numbers);
    if (!is_letter(keyword[0])) cursor_.refuse_word("stands where a keyword is expected", keyword);
    for (const Section& section : kOtherCells)
      if (keyword == section.keyword) builder_.count_other_cells(section, numbers);
    while (is_content(cursor_.peek_word())) cursor_.word("a number");
  }

  Cursor cursor_;
  MeditBuilder builder_;
};

class MeditBinaryReader {
 public:
  explicit MeditBinaryReader(const MeshFile& file) : cursor_(file), builder_(file) { cursor_.name_bytes(); }

  Mesh read() {
    const auto mark = cursor_.raw_number<std::int32_t>(false, "the mark of the byte order");
    constexpr std::int32_t kMark = 1, kSwappedMark = 1 << 24;
    if (mark != kMark && mark != kSwappedMark) cursor_.refuse("not a .meshb file: its first number is not 1");
    const bool is_swapped = mark == kSwappedMark;
    const auto version = cursor_.raw_number<std::int32_t>(is_swapped, "the version");
    if (version < 1 || version > 4) cursor_.refuse(fmt::format("version {} is not 1, 2, 3 or 4", version));
    BinaryNumbers numbers(cursor_, version, is_swapped);
    for (std::int32_t code; (code = numbers.int32("a keyword")) != kEndCode;) {
      const std::int64_t next = numbers.position("the position of the next keyword");
      if (next < static_cast<std::int64_t>(cursor_.position()))
        cursor_.refuse(fmt::format("keyword {} says that the next one is before it, at byte {}", code, next));
      read_section(code, numbers);
      if (static_cast<std::int64_t>(cursor_.position()) > next)
        cursor_.refuse(fmt::format("section of keyword {} runs past its end at byte {}", code, next));
      cursor_.move_to(static_cast<std::size_t>(next));
    }
    return builder_.take(fmt::format("Medit, binary version {}", version));
  }

 private:
  void read_section(std::int32_t code, BinaryNumbers numbers) {
    if (code == kDimensionCode && numbers.int32("the dimension") != 3)
      cursor_.refuse("the dimension is not 3");
    if (code == kVertices.code) builder_.read_vertices(numbers);
    for (const Section& section : kCells)
      if (code == section.code) builder_.read_cells(section, numbers);
    for (const Section& section : kOtherCells)
      if (code == section.code) builder_.count_other_cells(section, numbers);
  }

  Cursor cursor_;
  MeditBuilder builder_;
};

}  // namespace

Mesh read_medit(const MeshFile& file) { return MeditTextReader(file).read(); }
Mesh read_medit_binary(const MeshFile& file) { return MeditBinaryReader(file).read(); }

}  // namespace podm::verify
