// Gmsh meshes (.msh) of the formats 2.x and 4.1, text and binary of either byte order.
// Format: Gmsh reference manual, "MSH file format".
//
// podm's comments give the space and the label of each physical group of volumes. The labels on the two sides
// of a facet come from comments in 2.2, and in 4.1 from the signs of the surfaces that bound a volume. The
// names of physical groups state which facets are on the sides of a flat box.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "readers/cursor.h"
#include "readers/formats.h"
#include "readers/gmsh_elements.h"
#include "readers/mesh_parts.h"

namespace podm::verify {
namespace {

constexpr std::size_t kMostNodes = 64;  // per element

// A volume on one side of a surface: side 0 is where the normals of its triangles point, side 1 behind them.
struct Side {
  std::int64_t surface;
  int number;
  LabelValue label;
};

class GmshReader {
 public:
  explicit GmshReader(const MeshFile& file) : file_(file), cursor_(file), elements_(file, tags_, mesh_) {}

  Mesh read() {
    read_format();
    while (!cursor_.is_at_last_word()) {
      const std::string_view head = cursor_.word("a section");
      if (head[0] != '$') cursor_.refuse_word("stands where a section is expected", head);
      read_section(std::string(head.substr(1)));
    }
    if (!has_nodes_ || !has_elements_)
      file_.refuse(has_nodes_ ? "$Elements" : "$Nodes", "the file has no such section");
    elements_.finish();
    name_labels();
    label_facets();
    return std::move(mesh_);
  }

 private:
  void read_format() {
    if (cursor_.word("$MeshFormat") != "$MeshFormat")
      cursor_.refuse("the file does not begin with $MeshFormat");
    const std::string version(cursor_.word("the version"));
    is_v4_ = version == "4.1";
    if (!is_v4_ && version != "2" && version != "2.0" && version != "2.1" && version != "2.2")
      cursor_.refuse_word("is a version that is not supported: 2.2 and 4.1 are", version);
    is_binary_ = integer_word("0 or 1, binary") == 1;
    size_bytes_ = integer_word("the size of a number");
    if (size_bytes_ != 8 && !(is_v4_ && size_bytes_ == 4))
      cursor_.refuse(fmt::format("numbers of {} bytes are not supported", size_bytes_));
    if (is_binary_) read_byte_order();
    expect_end("MeshFormat");
    mesh_.format = fmt::format("Gmsh {}, {}", version, is_binary_ ? "binary" : "ascii");
  }

  void read_byte_order() {
    cursor_.name_bytes();
    cursor_.rest_of_line();
    const auto mark = cursor_.raw_number<std::int32_t>(false, "the mark of the byte order");
    is_swapped_ = mark == 1 << 24;
    if (mark != 1 && !is_swapped_) cursor_.refuse("the mark of the byte order is not 1");
  }

  void read_section(const std::string& name) {
    if (name == "Comments") return read_comments();
    if (name == "PhysicalNames") {
      read_physical_names();
    } else if (name == "Nodes") {
      if (has_nodes_) cursor_.refuse("a second section $Nodes");
      is_v4_ ? read_nodes_v4() : read_nodes_v2();
      tags_.finish(file_, "$Nodes", "node tag");
      has_nodes_ = true;
    } else if (name == "Elements") {
      if (!has_nodes_) cursor_.refuse("$Elements before $Nodes");
      is_v4_ ? read_elements_v4() : read_elements_v2();
      has_elements_ = true;
    } else if (is_v4_ && (name == "Entities" || name == "PartitionedEntities")) {
      read_entities(name == "PartitionedEntities");
    } else {
      return skip_section(name);
    }
    expect_end(name);
  }

  void skip_section(const std::string& name) {
    const std::size_t end = file_.bytes().find("$End" + name, cursor_.position());
    if (end == std::string_view::npos) cursor_.refuse_word("is a section without its end", name);
    cursor_.move_to(end);
    expect_end(name);
  }

  void expect_end(const std::string& name) {
    if (cursor_.word("the end of a section") != "$End" + name)
      cursor_.refuse(fmt::format("${} is not closed here", name.substr(0, 40)));
  }

  // "space RAS", "label 7 physical volume 7 liver", "pair 0 7 physical surface 1"
  void read_comments() {
    cursor_.rest_of_line();
    while (true) {
      if (cursor_.is_at_end()) cursor_.refuse("$Comments is not closed");
      const std::string_view line = cursor_.rest_of_line();
      if (line.starts_with("$EndComments")) return;
      if (read_note(file_, "$Comments", line, mesh_)) continue;
      if (auto label = after_prefix(line, "label ")) {
        const auto value = take_integer(*label), group = integer_after(*label, "physical volume ");
        if (value && group) label_of_group_[*group] = *value;
      } else if (auto pair = after_prefix(line, "pair ")) {
        const auto labels = take_pair(*pair);
        const auto group = integer_after(*pair, "physical surface ");
        if (labels && group) surface_groups_[*group].labels = *labels;
      }
    }
  }

  void read_physical_names() {
    const std::size_t count = cursor_.count("the number of physical names", 4);
    for (std::size_t i = 0; i < count; ++i) {
      const int dimension = integer_word("a dimension");
      const int group = integer_word("a physical group");
      std::string_view name = cursor_.rest_of_line();
      const std::size_t open = name.find('"'), close = name.rfind('"');
      if (open == close) cursor_.refuse("the name of a physical group is not in quotes");
      name = name.substr(open + 1, close - open - 1);
      if (dimension == 3) group_names_[group] = name;
      const std::uint8_t side = std::max(side_of_set(name), side_of_pair(name));
      if (dimension == 2 && side > 0) side_of_group_[group] = side;
    }
  }

  // These read numbers of a section that is binary in binary files.
  std::int32_t integer(const char* what) {
    return is_binary_ ? cursor_.raw_number<std::int32_t>(is_swapped_, what) : integer_word(what);
  }
  std::uint64_t size(const char* what) {
    if (!is_binary_) return cursor_.number<std::uint64_t>(what);
    if (size_bytes_ == 4) return cursor_.raw_number<std::uint32_t>(is_swapped_, what);
    return cursor_.raw_number<std::uint64_t>(is_swapped_, what);
  }
  double real(const char* what) {
    return is_binary_ ? cursor_.raw_number<double>(is_swapped_, what) : cursor_.number<double>(what);
  }
  std::int32_t integer_word(const char* what) { return cursor_.number<std::int32_t>(what); }
  /// Reads a size that the rest of the file can hold at `least_bytes` each.
  std::size_t count(const char* what, std::size_t least_bytes) {
    const std::uint64_t value = size(what);
    cursor_.expect_room(value, least_bytes, what);
    return value;
  }

  // Entities give the physical groups, also in partitioned meshes, and the surfaces that bound a volume.
  void read_entities(bool is_partitioned) {
    if (is_binary_) cursor_.rest_of_line();
    if (is_partitioned) {
      size("the number of partitions");
      for (std::size_t n = count("the number of ghost entities", 4); n > 0; --n) {
        integer("a ghost entity");
        integer("a partition");
      }
    }
    std::array<std::size_t, 4> counts;
    for (std::size_t& n : counts) n = count("the number of entities", 4);
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t n = counts[dimension]; n > 0; --n) read_entity(dimension, is_partitioned);
  }

  void read_entity(int dimension, bool is_partitioned) {
    const std::int32_t tag = integer("the tag of an entity");
    if (is_partitioned) {
      integer("the dimension of a parent");
      integer("the tag of a parent");
      for (std::size_t n = count("the number of partitions", 2); n > 0; --n) integer("a partition");
    }
    for (int i = dimension == 0 ? 3 : 6; i > 0; --i) real("the box of an entity");
    std::int64_t group = 0;  // the first group
    for (std::size_t i = 0, n = count("the number of physical groups", 2); i < n; ++i) {
      const std::int64_t next = integer("a physical group");
      if (i == 0) group = next < 0 ? -next : next;
      if (dimension == 2) groups_of_surface_.emplace(tag, next < 0 ? -next : next);
    }
    if (group != 0) groups_[{dimension, tag}] = group;
    if (dimension == 0) return;
    for (std::size_t n = count("the number of bounding entities", 2); n > 0; --n) {
      const std::int64_t bound = integer("a bounding entity");
      if (dimension == 3) sides_.push_back({bound < 0 ? -bound : bound, bound < 0 ? 0 : 1, label_of(group)});
    }
  }

  void read_nodes_v4() {
    if (is_binary_) cursor_.rest_of_line();
    std::size_t num_blocks = count("the number of blocks", 4);
    const std::size_t num_nodes = count("the number of nodes", 8);
    size("the smallest tag");
    size("the greatest tag");
    for (; num_blocks > 0; --num_blocks) {
      const std::int32_t dimension = integer("the dimension of a block");
      integer("the entity of a block");
      const bool is_parametric = integer("0 or 1, parametric") != 0;
      const std::size_t block = count("the nodes of a block", 8);
      reserve_vertices(block);
      for (std::size_t i = 0; i < block; ++i) tags_.add(size("a node tag"));
      for (std::size_t i = 0; i < block; ++i) {
        add_vertex();
        for (int k = 0; is_parametric && k < dimension; ++k) real("a parametric coordinate");
      }
    }
    check_number("nodes", tags_.size(), num_nodes);
  }

  void read_nodes_v2() {
    const std::size_t num_nodes = cursor_.count("the number of nodes", 8);
    if (is_binary_) cursor_.rest_of_line();
    reserve_vertices(num_nodes);
    for (std::size_t i = 0; i < num_nodes; ++i) {
      tags_.add(tag_v2());
      add_vertex();
    }
  }

  // Tags of format 2 are ints. A negative tag becomes a number that no node has.
  std::uint64_t tag_v2() { return static_cast<std::uint64_t>(std::int64_t{integer("a node tag")}); }

  void reserve_vertices(std::size_t count) {
    check_counts(file_, "$Nodes", mesh_.vertices.size() + count, 0);
    make_room(mesh_.vertices, count);
  }

  void add_vertex() {
    const double x = real("a coordinate"), y = real("a coordinate"), z = real("a coordinate");
    mesh_.vertices.push_back({x, y, z});
  }

  void read_elements_v4() {
    if (is_binary_) cursor_.rest_of_line();
    std::size_t num_blocks = count("the number of blocks", 4), num_read = 0;
    const std::size_t num_elements = count("the number of elements", 4);
    size("the smallest tag");
    size("the greatest tag");
    for (; num_blocks > 0; --num_blocks) {
      const std::int32_t dimension = integer("the dimension of a block"), entity = integer("an entity");
      const std::int32_t type = integer("an element type");
      const std::size_t num_nodes = nodes_of(type);
      const std::size_t block = count("the elements of a block", 2 * (num_nodes + 1));
      const auto group = groups_.find({dimension, entity});
      elements_.make_room(type, block);
      for (std::size_t i = 0; i < block; ++i) {
        size("an element tag");
        for (std::size_t k = 0; k < num_nodes; ++k) nodes_[k] = size("a node tag");
        add_element(type, num_nodes, {group == groups_.end() ? 0 : label_of(group->second), entity});
      }
      num_read += block;
    }
    check_number("elements", num_read, num_elements);
  }

  void read_elements_v2() {
    const std::size_t num_elements = cursor_.count("the number of elements", 4);
    if (is_binary_) cursor_.rest_of_line();
    for (std::size_t num_read = 0; num_read < num_elements;) num_read += read_elements_block_v2();
  }

  // Reads the elements under one head and returns their number. In binary files a head holds for several
  // elements; in text each line has its own.
  std::size_t read_elements_block_v2() {
    if (!is_binary_) integer("an element tag");
    const std::int32_t type = integer("an element type");
    const std::size_t num_nodes = nodes_of(type);
    const std::int32_t block = is_binary_ ? integer("the elements of a block") : 1;
    const std::int32_t num_tags = integer("the number of tags");
    if (block <= 0 || num_tags < 0) cursor_.refuse("a negative number of elements or tags");
    cursor_.expect_room(static_cast<std::uint32_t>(block), 2 * num_nodes, "the elements of a block");
    if (is_binary_) elements_.make_room(type, static_cast<std::size_t>(block));
    for (std::int32_t i = 0; i < block; ++i) {
      if (is_binary_) integer("an element tag");
      GmshGroup group;
      for (std::int32_t k = 0; k < num_tags; ++k) {
        const std::int32_t tag = integer("a tag of an element");
        if (k == 0) group.physical = tag;
        if (k == 1) group.entity = tag;
      }
      for (std::size_t k = 0; k < num_nodes; ++k) nodes_[k] = tag_v2();
      add_element(type, num_nodes, group);
    }
    return static_cast<std::size_t>(block);
  }

  void add_element(std::int32_t type, std::size_t num_nodes, const GmshGroup& group) {
    elements_.add(type, {nodes_.data(), num_nodes}, group);
  }

  std::size_t nodes_of(std::int32_t type) const {
    const std::size_t num_nodes = gmsh_nodes_of(type);
    if (num_nodes == 0) cursor_.refuse(fmt::format("element type {} is not known", type));
    return num_nodes;
  }

  void check_number(const char* what, std::size_t num_read, std::size_t announced) const {
    if (num_read != announced)
      cursor_.refuse(fmt::format("the blocks hold {} {}, {} are announced", num_read, what, announced));
  }

  LabelValue label_of(std::int64_t group) const {
    const auto label = label_of_group_.find(group);
    return label == label_of_group_.end() ? group : label->second;
  }

  void name_labels() {
    if (mesh_.cell_label_array != kPhysicalLabels) return;  // the names are those of physical groups
    for (const auto& [group, name] : group_names_) mesh_.label_names[label_of(group)] = name;
  }

  // In podm's files the normal of a facet points from the second label to the first. The outside of all
  // volumes has the background's label 0, or -1 if a volume has label 0.
  void label_facets() {
    for (auto& [group, facets] : surface_groups_) facets.side = side_of_group(group);
    if (!surface_groups_.empty())
      return verify::label_facets(file_, "$Elements", "surface", elements_.facet_entities(), surface_groups_,
                                  mesh_);
    if (label_of_group_.empty()) return;
    LabelValue outside = 0;
    for (const auto& [group, label] : label_of_group_)
      if (label == 0) outside = -1;
    std::stable_sort(sides_.begin(), sides_.end(),
                     [](const Side& a, const Side& b) { return a.surface < b.surface; });
    for (const std::int64_t surface : elements_.facet_entities()) {
      auto side = std::lower_bound(sides_.begin(), sides_.end(), surface,
                                   [](const Side& a, std::int64_t value) { return a.surface < value; });
      std::array<LabelValue, 2> labels{outside, outside};
      if (side == sides_.end() || side->surface != surface)
        file_.refuse("$Elements", fmt::format("surface {} bounds no volume", surface));
      for (; side != sides_.end() && side->surface == surface; ++side) labels[side->number] = side->label;
      mesh_.facet_labels.push_back(labels);
      mesh_.facet_sides.push_back(side_of_surface(surface));
    }
  }

  std::uint8_t side_of_group(std::int64_t group) const {
    const auto side = side_of_group_.find(group);
    return side == side_of_group_.end() ? std::uint8_t{0} : side->second;
  }
  std::uint8_t side_of_surface(std::int64_t surface) const {
    std::uint8_t side = 0;
    const auto [first, last] = groups_of_surface_.equal_range(surface);
    for (auto group = first; group != last; ++group) side = std::max(side, side_of_group(group->second));
    return side;
  }

  const MeshFile& file_;
  Cursor cursor_;
  Mesh mesh_;
  bool is_v4_ = false, is_binary_ = false, is_swapped_ = false, has_nodes_ = false, has_elements_ = false;
  int size_bytes_ = 8;
  ItemNumbers tags_;
  GmshElements elements_;
  std::array<std::uint64_t, kMostNodes> nodes_{};                // of the current element
  std::map<std::int64_t, LabelValue> label_of_group_;            // of volumes, from podm's comments
  FacetGroups surface_groups_;                                   // from podm's comments
  std::map<std::int64_t, std::uint8_t> side_of_group_;           // of a flat box, by physical group
  std::multimap<std::int64_t, std::int64_t> groups_of_surface_;  // by entity
  std::map<std::int64_t, std::string> group_names_;              // of volumes
  std::map<std::pair<int, std::int64_t>, std::int64_t> groups_;  // by dimension and entity
  std::vector<Side> sides_;
};

}  // namespace

Mesh read_gmsh(const MeshFile& file) { return GmshReader(file).read(); }

}  // namespace podm::verify
