// Exodus II (.e, .exo, .ex2, .g): blocks of tetrahedra and triangles with names, and the side sets that podm
// writes. A cell's label is the number of its block, unless podm's information records give another.
// Format: "EXODUS: A Finite Element Data Model".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "readers/formats.h"
#include "readers/mesh_parts.h"
#include "readers/netcdf_document.h"

namespace podm::verify {
namespace {

class ExodusReader {
 public:
  explicit ExodusReader(const MeshFile& file) : file_(file), document_(file) {}

  Mesh read() {
    mesh_.format = fmt::format("Exodus II, netCDF classic {}", document_.version());
    read_information();
    read_points();
    read_blocks();
    if (mesh_.facets.empty()) read_side_sets();
    return std::move(mesh_);
  }

 private:
  struct Block {
    std::uint64_t first_element, num_elements;  // counted from 0 over all blocks
    bool is_solid;
    std::size_t first_cell;
  };

  // "space RAS", "label 7 block 7", "pair 0 7 side set 1"
  void read_information() {
    for (const std::string& line : document_.texts("info_records")) {
      if (read_note(file_, "info_records", line, mesh_)) continue;
      if (auto label = after_prefix(line, "label ")) {
        const auto value = take_integer(*label), block = integer_after(*label, "block ");
        if (value && block) label_of_block_[*block] = *value;
      } else if (auto pair = after_prefix(line, "pair ")) {
        const auto labels = take_pair(*pair);
        if (const auto set = integer_after(*pair, "side set "); labels && set) pair_of_set_[*set] = *labels;
      }
    }
  }

  // Coordinates are stored by axis, or in older files all x before all y.
  void read_points() {
    const std::uint64_t count = document_.size_of("num_nodes");
    check_counts(file_, "num_nodes", count, 0);
    if (document_.size_of("num_dim") != 3) file_.refuse("num_dim", "the dimension is not 3");
    const bool is_by_axis = document_.find("coordx") != nullptr;
    std::array<NumberArray, 3> axes;
    if (is_by_axis)
      for (std::size_t axis = 0; axis < 3; ++axis)
        axes[axis] = document_.numbers(fmt::format("coord{}", "xyz"[axis]), count);
    const NumberArray all = is_by_axis ? NumberArray() : document_.numbers("coord", 3 * count);
    make_room(mesh_.vertices, count);
    for (std::size_t i = 0; i < count; ++i) {
      Point& point = mesh_.vertices.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis)
        point[axis] = is_by_axis ? axes[axis].real(i) : all.real(axis * count + i);
    }
  }

  void read_blocks() {
    const std::uint64_t num_blocks = document_.size_of("num_el_blk");
    if (num_blocks == 0) file_.refuse("num_el_blk", "the file has no block of elements");
    const NumberArray ids = document_.numbers("eb_prop1", num_blocks);
    const std::vector<std::string> names = document_.texts("eb_names");
    std::uint64_t first_element = 0;
    for (std::size_t i = 0; i < num_blocks; ++i) {
      const std::uint64_t count = document_.size_of(fmt::format("num_el_in_blk{}", i + 1));
      if (count == 0) continue;
      const std::string name = i < names.size() ? names[i] : "";
      read_block(i + 1, count, first_element, label_of(ids.integer(i)), name);
      first_element += count;
    }
    if (!mesh_.cells.empty()) mesh_.cell_label_array = "eb_prop1";
  }

  LabelValue label_of(const std::optional<std::int64_t>& id) const {
    if (!id) file_.refuse("variable 'eb_prop1'", "a block's number is not an integer");
    const auto label = label_of_block_.find(*id);
    return label == label_of_block_.end() ? *id : label->second;
  }

  void read_block(std::size_t number, std::uint64_t count, std::uint64_t first_element, LabelValue label,
                  const std::string& name) {
    const std::string connect = fmt::format("connect{}", number);
    const std::uint64_t num_nodes = document_.size_of(fmt::format("num_nod_per_el{}", number));
    const NetcdfVariable* variable = document_.find(connect);
    if (variable == nullptr)
      file_.refuse(fmt::format("variable '{}'", connect), "the file has no such variable");
    const auto type = variable->attributes.find("elem_type");
    const std::string shape = upper(type == variable->attributes.end() ? "" : type->second);
    const bool is_solid = shape.starts_with("TET"), is_triangle = shape.starts_with("TRI");
    blocks_.push_back({first_element, count, is_solid, mesh_.cells.size()});
    if (!is_solid && !is_triangle) {
      mesh_.other_cells[fmt::format("elements of Exodus type '{}'", shape.substr(0, 32))] += count;
      return;
    }
    const std::uint64_t corners = is_solid ? 4 : 3;
    if (num_nodes < corners)
      file_.refuse(fmt::format("variable '{}'", connect),
                   fmt::format("{} nodes an element of {}", num_nodes, shape));
    if (num_nodes > corners)
      mesh_.other_cells[is_solid ? kQuadraticTetrahedra : kQuadraticTriangles] += count;
    check_counts(file_, connect, 0, mesh_.cells.size() + count);
    const NumberArray nodes = document_.numbers(connect, count * num_nodes);
    for (std::uint64_t i = 0; i < count; ++i)
      is_solid ? add_cell(nodes, i * num_nodes, label) : add_triangle(nodes, i * num_nodes);
    if (is_solid && !name.empty()) mesh_.label_names[label] = name;
  }

  static VertexId vertex(const NumberArray& nodes, std::size_t i) {
    const auto number = nodes.integer(i);
    return number && *number > 0 ? vertex_id(*number - 1) : kNone;
  }
  void add_cell(const NumberArray& nodes, std::size_t i, LabelValue label) {
    mesh_.cells.push_back(
        {vertex(nodes, i), vertex(nodes, i + 1), vertex(nodes, i + 2), vertex(nodes, i + 3)});
    mesh_.cell_labels.push_back(label);
  }
  void add_triangle(const NumberArray& nodes, std::size_t i) {
    mesh_.facets.push_back({vertex(nodes, i), vertex(nodes, i + 1), vertex(nodes, i + 2)});
  }

  // Without label pairs in podm's records the side sets carry no labels and are skipped.
  void read_side_sets() {
    if (pair_of_set_.empty()) return;
    const std::uint64_t num_sets = document_.size_of("num_side_sets");
    const NumberArray ids = document_.numbers("ss_prop1", num_sets);
    const std::vector<std::string> names = document_.texts("ss_names");
    std::vector<CellSide> facets;
    std::vector<std::pair<CellSide, std::uint8_t>> sides;
    for (std::size_t i = 0; i < num_sets; ++i) {
      const std::uint8_t side = i < names.size() ? side_of_set(names[i]) : std::uint8_t{0};
      if (side > 0)
        for (const CellSide each : read_side_set(i + 1)) sides.emplace_back(each, side);
      if (side > 0) continue;
      const auto pair = pair_of_set_.find(ids.integer(i).value_or(-1));
      if (pair == pair_of_set_.end())
        file_.refuse("info_records",
                     fmt::format("side set {} has no line 'pair'", ids.integer(i).value_or(-1)));
      for (const CellSide each : read_side_set(i + 1)) {
        add_facet(each, pair->second);
        facets.push_back(each);
      }
    }
    mark_facet_sides(facets, sides, mesh_);
  }

  std::vector<CellSide> read_side_set(std::size_t number) {
    const std::uint64_t count = document_.size_of(fmt::format("num_side_ss{}", number));
    const std::string list = fmt::format("elem_ss{}", number);
    const NumberArray elements = document_.numbers(list, count);
    const NumberArray sides = document_.numbers(fmt::format("side_ss{}", number), count);
    std::vector<CellSide> all;
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t side = sides.integer(i).value_or(0);
      const std::size_t cell = cell_of(elements.integer(i).value_or(0));
      if (side < 1 || side > 4 || cell >= mesh_.cells.size())
        file_.refuse(fmt::format("variable '{}'", list),
                     fmt::format("entry {} is not a side of a tetrahedron", i));
      all.push_back(4 * CellSide{cell} + static_cast<CellSide>(side - 1));
    }
    return all;
  }
  void add_facet(CellSide side, const std::array<LabelValue, 2>& labels) {
    constexpr std::array<std::array<int, 3>, 4> kOutward{{{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}}};
    const auto& corners = mesh_.cells[side / 4];
    const auto& [a, b, c] = kOutward[side % 4];
    mesh_.facets.push_back({corners[a], corners[b], corners[c]});
    mesh_.facet_labels.push_back(labels);
  }

  // Returns kNone for an element that is no tetrahedron.
  std::size_t cell_of(std::int64_t element) const {
    const auto number = static_cast<std::uint64_t>(element) - 1;  // 0 wraps around
    auto block =
        std::upper_bound(blocks_.begin(), blocks_.end(), number,
                         [](std::uint64_t value, const Block& b) { return value < b.first_element; });
    if (block == blocks_.begin()) return kNone;
    --block;
    const std::uint64_t position = number - block->first_element;
    return block->is_solid && position < block->num_elements ? block->first_cell + position : kNone;
  }

  const MeshFile& file_;
  NetcdfDocument document_;
  Mesh mesh_;
  std::vector<Block> blocks_;
  std::map<std::int64_t, LabelValue> label_of_block_;  // from podm's information records
  std::map<std::int64_t, std::array<LabelValue, 2>> pair_of_set_;
};

}  // namespace

Mesh read_exodus(const MeshFile& file) { return ExodusReader(file).read(); }

}  // namespace podm::verify
