// Abaqus input (.inp): *NODE, *ELEMENT with ELSET=, and the *SURFACE of element sides that podm writes. The
// sets of cells are their labels. Labels are numbered from 1 in the file's order, unless podm's comments give
// their values. Sets that only list elements, parts, instances and included files are not read.
// Format: Abaqus Keywords Guide.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>

#include "readers/cursor.h"
#include "readers/formats.h"
#include "readers/item_numbers.h"
#include "readers/mesh_parts.h"

namespace podm::verify {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Removes the part of a line before its next comma, and the comma, and returns the part.
std::string_view take_field(std::string_view& line) {
  const std::size_t comma = line.find(',');
  const std::string_view field = trimmed(line.substr(0, comma));
  line = comma == std::string_view::npos ? std::string_view{} : line.substr(comma + 1);
  return field;
}

enum class Shape { kTetrahedron, kTriangle, kOther };

struct ElementType {
  const char* name;
  Shape shape;
  std::size_t num_nodes;
  const char* other;  // name it is counted under, in addition to its shape
};
constexpr ElementType kTypes[] = {{"C3D4", Shape::kTetrahedron, 4, nullptr},
                                  {"C3D10", Shape::kTetrahedron, 10, kQuadraticTetrahedra},
                                  {"S3", Shape::kTriangle, 3, nullptr},
                                  {"CPS3", Shape::kTriangle, 3, nullptr},
                                  {"CPE3", Shape::kTriangle, 3, nullptr},
                                  {"STRI3", Shape::kTriangle, 3, nullptr},
                                  {"S6", Shape::kTriangle, 6, kQuadraticTriangles},
                                  {"C3D6", Shape::kOther, 6, "wedges"},
                                  {"C3D15", Shape::kOther, 15, "wedges"},
                                  {"C3D8", Shape::kOther, 8, "hexahedra"},
                                  {"C3D20", Shape::kOther, 20, "hexahedra"},
                                  {"S4", Shape::kOther, 4, "quadrilaterals"},
                                  {"S8", Shape::kOther, 8, "quadrilaterals"},
                                  {"T3D2", Shape::kOther, 2, "lines"},
                                  {"B31", Shape::kOther, 2, "lines"}};
constexpr std::size_t kMostNodes = 20;

// Letters at the end of a type name the integration: C3D10M, S3R.
const ElementType* find_type(std::string_view name) {
  while (!name.empty() && name.back() >= 'A' && name.back() <= 'Z') name.remove_suffix(1);
  const auto* found = std::find_if(std::begin(kTypes), std::end(kTypes),
                                   [&](const ElementType& type) { return name == type.name; });
  return found == std::end(kTypes) ? nullptr : found;
}

class AbaqusReader {
 public:
  explicit AbaqusReader(const MeshFile& file) : file_(file), cursor_(file) {}

  Mesh read() {
    while (next_line()) line_[0] == '*' ? read_keyword() : read_data();
    if (!has_nodes_) file_.refuse("*NODE", "the file has no such section");
    mesh_.format = "Abaqus input";
    connect();
    label_cells();
    return std::move(mesh_);
  }

 private:
  enum class Section { kOther, kNodes, kElements, kSurface };

  struct Side {
    std::uint64_t element;
    std::uint32_t number;  // counted from 0
    std::array<LabelValue, 2> labels;
    std::uint8_t box_side;  // above 0: the facet is listed elsewhere, too
  };

  // Goes to the next line that is neither empty nor a comment.
  bool next_line() {
    while (!cursor_.is_at_end()) {
      line_ = trimmed(cursor_.rest_of_line());
      if (line_.starts_with("**"))
        read_comment(line_.substr(2));
      else if (!line_.empty())
        return true;
    }
    return false;
  }

  // " space RAS", " label 7 elset liver the liver", " pair 0 7 surface liver-outside the liver|outside"
  void read_comment(std::string_view text) {
    const auto note = after_prefix(text, " ");
    if (!note || read_note(file_, "a comment", *note, mesh_)) return;
    if (auto label = after_prefix(*note, "label ")) {
      const auto value = take_integer(*label);
      const auto set = value ? after_prefix(*label, "elset ") : std::nullopt;
      const std::size_t blank = set ? set->find(' ') : std::string_view::npos;
      if (blank == std::string_view::npos) return;
      label_of_set_[upper(set->substr(0, blank))] = *value;
      mesh_.label_names[*value] = set->substr(blank + 1);
    } else if (auto pair = after_prefix(*note, "pair ")) {
      const auto labels = take_pair(*pair);
      const auto surface = after_prefix(*pair, "surface ");
      if (labels && surface) pair_of_surface_[upper(surface->substr(0, surface->find(' ')))] = *labels;
    }
  }

  void read_keyword() {
    const std::string keyword = upper(take_field(line_));
    parameters_.clear();
    while (!line_.empty()) {
      const std::string_view field = take_field(line_);
      const std::size_t equals = std::min(field.find('='), field.size());
      parameters_[upper(trimmed(field.substr(0, equals)))] =
          trimmed(field.substr(std::min(equals + 1, field.size())));
    }
    section_ = Section::kOther;
    if (keyword == "*NODE") {
      section_ = Section::kNodes;
      has_nodes_ = true;
    } else if (keyword == "*ELEMENT") {
      begin_elements();
    } else if (keyword == "*SURFACE") {
      begin_surface();
    } else if (keyword == "*INCLUDE" || keyword == "*INSTANCE" || keyword == "*SYSTEM") {
      cursor_.refuse_word("is not supported: a flat file is read", keyword);
    }
  }

  std::string need_parameter(const std::string& name) const {
    const auto found = parameters_.find(name);
    if (found == parameters_.end() || found->second.empty())
      cursor_.refuse(fmt::format("the keyword has no {}=", name));
    return found->second;
  }

  void begin_elements() {
    const std::string name = upper(need_parameter("TYPE"));
    type_ = find_type(name);
    if (type_ == nullptr) cursor_.refuse_word("is an element type that is not known", name);
    section_ = Section::kElements;
    set_ = parameters_.contains("ELSET") ? need_parameter("ELSET") : "";
    set_number_ = set_numbers_.try_emplace(upper(set_), set_numbers_.size()).first->second;
    if (set_number_ == set_names_.size()) set_names_.push_back(set_);
  }

  // Only surfaces that podm's comments pair with labels are read, and those of the sides of a flat box.
  void begin_surface() {
    if (pair_of_surface_.empty()) return;
    const std::string name = upper(need_parameter("NAME"));
    const auto pair = pair_of_surface_.find(name);
    box_side_ = pair == pair_of_surface_.end() ? side_of_surface(name) : std::uint8_t{0};
    if (pair == pair_of_surface_.end() && box_side_ == 0) return;
    if (box_side_ == 0) labels_of_side_ = pair->second;
    section_ = Section::kSurface;
  }

  // "BOX_I-", and "BOX_I_" for i+, as names have no plus
  static std::uint8_t side_of_surface(const std::string& name) {
    if (name.size() != 6 || !name.starts_with("BOX_")) return 0;
    return side_of_set(std::string("box ") + static_cast<char>(name[4] - 'A' + 'a') +
                       (name[5] == '_' ? '+' : name[5]));
  }

  void read_data() {
    if (section_ == Section::kNodes) read_node();
    if (section_ == Section::kElements) read_element();
    if (section_ == Section::kSurface) read_side();
  }

  template <class Number>
  Number take(const char* what) {
    std::string_view field = take_field(line_);
    if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
    Number value{};
    const auto [after, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || after != field.data() + field.size())
      cursor_.refuse_word(fmt::format("is not a number ({})", what).c_str(), field);
    return value;
  }

  void read_node() {
    check_counts(file_, "*NODE", mesh_.vertices.size() + 1, 0);
    node_numbers_.add(take<std::uint64_t>("the number of a node"));
    Point point;
    for (double& coordinate : point) coordinate = take<double>("a coordinate");
    mesh_.vertices.push_back(point);
  }

  // The nodes may continue on further lines.
  void read_element() {
    const auto number = take<std::uint64_t>("the number of an element");
    std::array<std::uint64_t, kMostNodes> nodes;
    for (std::size_t i = 0; i < type_->num_nodes; ++i) {
      if (line_.empty() && (!next_line() || line_[0] == '*'))
        cursor_.refuse(fmt::format("an element of {} nodes ends after {}", type_->num_nodes, i));
      nodes[i] = take<std::uint64_t>("a node of an element");
    }
    if (type_->other != nullptr) ++mesh_.other_cells[type_->other];
    if (type_->shape == Shape::kTetrahedron) {
      check_counts(file_, "*ELEMENT", 0, cells_.size() + 1);
      cell_numbers_.add(number);
      cells_.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
      set_of_cell_.push_back(set_number_);
    } else if (type_->shape == Shape::kTriangle) {
      triangles_.push_back({nodes[0], nodes[1], nodes[2]});
    }
  }

  void read_side() {
    const auto element = take<std::uint64_t>("the number of an element");
    const std::string_view side = take_field(line_);
    if (side.size() != 2 || (side[0] != 'S' && side[0] != 's') || side[1] < '1' || side[1] > '4')
      cursor_.refuse_word("is not a side of a tetrahedron, S1 to S4", side);
    sides_.push_back({element, static_cast<std::uint32_t>(side[1] - '1'), labels_of_side_, box_side_});
  }

  template <std::size_t N>
  std::array<VertexId, N> vertices_of(const std::array<std::uint64_t, N>& nodes) const {
    std::array<VertexId, N> vertices;
    for (std::size_t i = 0; i < N; ++i) vertices[i] = node_numbers_.find(nodes[i]);
    return vertices;
  }

  // Nodes may come after the elements.
  void connect() {
    node_numbers_.finish(file_, "*NODE", "node number");
    cell_numbers_.finish(file_, "*ELEMENT", "element number");
    for (const auto& nodes : cells_) mesh_.cells.push_back(vertices_of(nodes));
    for (const auto& nodes : triangles_) mesh_.facets.push_back(vertices_of(nodes));
    if (!triangles_.empty()) return;  // triangles and sides would be two lists of facets
    constexpr std::array<std::array<int, 3>, 4> kOutward{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    std::vector<CellSide> facets;
    std::vector<std::pair<CellSide, std::uint8_t>> sides;
    for (const Side& side : sides_) {
      const VertexId cell = cell_numbers_.find(side.element);
      if (cell == kNone)
        file_.refuse("*SURFACE", fmt::format("no tetrahedron has the number {}", side.element));
      const CellSide cell_side = 4 * CellSide{cell} + side.number;
      if (side.box_side > 0) {
        sides.emplace_back(cell_side, side.box_side);
        continue;
      }
      facets.push_back(cell_side);
      const auto& [i, j, k] = kOutward[side.number];
      const auto& corners = mesh_.cells[cell];
      mesh_.facets.push_back({corners[i], corners[j], corners[k]});
      mesh_.facet_labels.push_back(side.labels);
    }
    mark_facet_sides(facets, sides, mesh_);
  }

  // If any cell has no set, the file has no labels.
  void label_cells() {
    const auto nameless = set_numbers_.find("");
    if (mesh_.cells.empty()) return;
    if (nameless != set_numbers_.end() &&
        std::find(set_of_cell_.begin(), set_of_cell_.end(), nameless->second) != set_of_cell_.end())
      return;
    std::vector<LabelValue> value_of_set;
    for (const std::string& name : set_names_)
      value_of_set.push_back(label_of(name, value_of_set.size() + 1));
    for (const std::size_t set : set_of_cell_) mesh_.cell_labels.push_back(value_of_set[set]);
    mesh_.cell_label_array = "ELSET";
  }

  LabelValue label_of(const std::string& set, std::size_t number) {
    const auto label = label_of_set_.find(upper(set));
    if (label != label_of_set_.end()) return label->second;
    if (!label_of_set_.empty()) file_.refuse("*ELEMENT", fmt::format("set '{}' has no line '** label'", set));
    mesh_.label_names[static_cast<LabelValue>(number)] = set;
    return static_cast<LabelValue>(number);
  }

  const MeshFile& file_;
  Cursor cursor_;
  Mesh mesh_;
  std::string_view line_;  // rest of the line
  Section section_ = Section::kOther;
  std::map<std::string, std::string> parameters_;  // of the current keyword
  const ElementType* type_ = nullptr;
  std::string set_;
  std::size_t set_number_ = 0;
  std::array<LabelValue, 2> labels_of_side_{};
  std::uint8_t box_side_ = 0;
  bool has_nodes_ = false;
  ItemNumbers node_numbers_, cell_numbers_;
  std::vector<std::array<std::uint64_t, 4>> cells_;  // by node numbers
  std::vector<std::array<std::uint64_t, 3>> triangles_;
  std::vector<std::size_t> set_of_cell_;
  std::vector<Side> sides_;
  std::map<std::string, std::size_t> set_numbers_;  // by name in capitals
  std::vector<std::string> set_names_;
  std::map<std::string, LabelValue> label_of_set_;  // from podm's comments
  std::map<std::string, std::array<LabelValue, 2>> pair_of_surface_;
};

}  // namespace

Mesh read_abaqus(const MeshFile& file) { return AbaqusReader(file).read(); }

}  // namespace podm::verify
