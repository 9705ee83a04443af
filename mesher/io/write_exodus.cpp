// Exodus II: one element block per label, one side set per label pair and per side of a flat box, one node
// set per line, all with the names and numbers of Gmsh files. Elements are numbered block after block.
// Information records list the space, labels and pairs. The arrays are those that the Exodus library makes
// for a mesh without fields in a netCDF file. Format: "EXODUS: A Finite Element Data Model", appendix
// "Implementation of EXODUS with netCDF".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "files/atomic_file.h"
#include "files/big_endian.h"
#include "io/facet_sides.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/netcdf_file.h"
#include "io/promises.h"
#include "podm/errors.h"

namespace podm {
namespace {

// Lengths that all readers hold, and that netCDF holds.
constexpr std::size_t kShortName = 32, kMostNameBytes = 255;
constexpr std::size_t kLineBytes = 80;  // length of an information record
// Side 1 has vertices 1 2 4, 2: 2 3 4, 3: 1 4 3.
constexpr std::array<std::int32_t, 4> kSideOpposite{2, 3, 1, 4};

class ExodusWriter {
 public:
  explicit ExodusWriter(const TetMesh& mesh) : mesh_(mesh), sets_(mesh), sides_(find_facet_sides(mesh)) {
    std::size_t first = 0;
    for (const LabelIndex label : sets_.volumes) {
      first_element_.push_back(first);
      first += sets_.cells_of_label[label].size();
      block_names_.push_back(cut(sets_.names[label]));
    }
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i)
      add_side_set(MeshSets::surface_tag(i), sets_.names.of_pair(sets_.pairs[i]), sets_.facets_of_pair[i]);
    for (const std::size_t side : sets_.sides)
      add_side_set(sets_.side_tag(side), name_of_side(side), sets_.facets_of_side[side]);
    for (const std::string& name : sets_.line_names) node_set_names_.push_back(cut(name));
  }

  // Throws InputError if an array exceeds its 32-bit size.
  void check_size(const std::string& path) const {
    constexpr std::size_t kMostBytes = std::numeric_limits<std::uint32_t>::max() - 3;
    bool fits = mesh_.vertices.size() <= kMostBytes / sizeof(double);
    for (const LabelIndex label : sets_.volumes)
      fits = fits && sets_.cells_of_label[label].size() <= kMostBytes / (4 * sizeof(std::int32_t));
    if (!fits) throw InputError(fmt::format("cannot write {}: an array of Exodus II exceeds 4 GiB", path));
  }

  Losses write(AtomicFile& file) {
    declare_attributes();
    const Dimension name_bytes = file_.add_dimension("len_name", longest_name_ + 1);
    const Dimension time_step = file_.add_dimension("time_step", 0);
    add_points(name_bytes);
    add_information();
    add_blocks(name_bytes);
    if (!side_sets_.empty()) add_side_sets(name_bytes);
    if (!node_set_names_.empty()) add_node_sets(name_bytes);
    file_.add_variable("time_whole", NetcdfFile::kDouble, {time_step}, {});
    file_.write(file);
    return losses_;
  }

 private:
  using Dimension = NetcdfFile::Dimension;

  struct SideSet {
    std::int32_t id;
    std::span<const std::uint32_t> facets;
  };

  void add_side_set(std::int32_t id, const std::string& name, std::span<const std::uint32_t> facets) {
    side_sets_.push_back({id, facets});
    side_set_names_.push_back(cut(name));
  }

  std::string cut(const std::string& name) {
    if (name.size() > kMostNameBytes)
      losses_.push_back(fmt::format("the name '{}' is cut to {} bytes", name, kMostNameBytes));
    const std::string kept = name.substr(0, kMostNameBytes);
    longest_name_ = std::max(longest_name_, kept.size());
    return kept;
  }

  void declare_attributes() {
    file_.add_attribute({"api_version", 5.0f});
    file_.add_attribute({"version", 5.0f});
    file_.add_attribute({"floating_point_word_size", 8});
    file_.add_attribute({"file_size", 1});  // one array of coordinates per axis
    file_.add_attribute({"maximum_name_length", static_cast<std::int32_t>(longest_name_)});
    file_.add_attribute({"int64_status", 0});
    file_.add_attribute({"title", "tetrahedral mesh of labels"});
  }

  void add_points(Dimension name_bytes) {
    const Dimension num_dim = file_.add_dimension("num_dim", 3);
    const Dimension num_nodes = file_.add_dimension("num_nodes", mesh_.vertices.size());
    file_.add_texts("coor_names", num_dim, name_bytes, {"x", "y", "z"});
    for (const int axis : {0, 1, 2}) {
      file_.add_variable(fmt::format("coord{}", "xyz"[axis]), NetcdfFile::kDouble, {num_nodes},
                         [this, axis](AtomicFile& file) {
                           for (const auto& vertex : mesh_.vertices) put_big_endian(file, vertex[axis]);
                         });
    }
  }

  // A record is too short for long names, so it lists labels and pairs by the numbers of their sets.
  void add_information() {
    std::vector<std::string> lines{"space " + to_string(mesh_.space)};
    for (const std::string& promise : promises_of(mesh_)) lines.push_back("promise " + promise);
    for (const LabelIndex label : sets_.volumes)
      lines.push_back(fmt::format("label {} block {}", mesh_.labels[label].value, sets_.volume_tags[label]));
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
      const auto [a, b] = sets_.pairs[i];
      lines.push_back(fmt::format("pair {} {} side set {}", mesh_.labels[a].value, mesh_.labels[b].value,
                                  MeshSets::surface_tag(i)));
    }
    const Dimension line_bytes = file_.add_dimension("len_line", kLineBytes + 1);
    const Dimension num_lines = file_.add_dimension("num_info", lines.size());
    file_.add_texts("info_records", num_lines, line_bytes, lines);
  }

  void add_blocks(Dimension name_bytes) {
    file_.add_dimension("num_elem", mesh_.cells.size());
    const Dimension num_blocks = file_.add_dimension("num_el_blk", sets_.volumes.size());
    std::vector<std::int32_t> ids;
    for (const LabelIndex label : sets_.volumes) ids.push_back(sets_.volume_tags[label]);
    file_.add_ints("eb_status", num_blocks, std::vector<std::int32_t>(ids.size(), 1));
    file_.add_ints("eb_prop1", num_blocks, ids, {{"name", "ID"}});
    file_.add_texts("eb_names", num_blocks, name_bytes, block_names_);
    for (std::size_t i = 0; i < sets_.volumes.size(); ++i) {
      const auto cells = sets_.cells_of_label[sets_.volumes[i]];
      const Dimension num_cells = file_.add_dimension(fmt::format("num_el_in_blk{}", i + 1), cells.size());
      const Dimension num_corners = file_.add_dimension(fmt::format("num_nod_per_el{}", i + 1), 4);
      file_.add_variable(fmt::format("connect{}", i + 1), NetcdfFile::kInt, {num_cells, num_corners},
                         [this, cells](AtomicFile& file) {
                           for (const std::uint32_t cell : cells)
                             for (const std::uint32_t vertex : mesh_.cells[cell])
                               put_big_endian(file, vertex + 1);
                         },
                         {{"elem_type", "TETRA"}});
    }
  }

  void add_side_sets(Dimension name_bytes) {
    const Dimension num_sets = file_.add_dimension("num_side_sets", side_sets_.size());
    std::vector<std::int32_t> ids;
    for (const SideSet& set : side_sets_) ids.push_back(set.id);
    file_.add_ints("ss_status", num_sets, std::vector<std::int32_t>(ids.size(), 1));
    file_.add_ints("ss_prop1", num_sets, ids, {{"name", "ID"}});
    file_.add_texts("ss_names", num_sets, name_bytes, side_set_names_);
    for (std::size_t i = 0; i < side_sets_.size(); ++i) {
      const auto facets = side_sets_[i].facets;
      const Dimension num_sides = file_.add_dimension(fmt::format("num_side_ss{}", i + 1), facets.size());
      file_.add_variable(fmt::format("elem_ss{}", i + 1), NetcdfFile::kInt, {num_sides},
                         [this, facets](AtomicFile& file) {
                           for (const std::uint32_t facet : facets)
                             put_big_endian(file, element_of(sides_[facet].cell));
                         });
      file_.add_variable(fmt::format("side_ss{}", i + 1), NetcdfFile::kInt, {num_sides},
                         [this, facets](AtomicFile& file) {
                           for (const std::uint32_t facet : facets)
                             put_big_endian(file, kSideOpposite[sides_[facet].opposite]);
                         });
    }
  }

  void add_node_sets(Dimension name_bytes) {
    const Dimension num_sets = file_.add_dimension("num_node_sets", node_set_names_.size());
    std::vector<std::int32_t> ids;
    for (std::size_t line = 0; line < node_set_names_.size(); ++line) ids.push_back(MeshSets::line_tag(line));
    file_.add_ints("ns_status", num_sets, std::vector<std::int32_t>(ids.size(), 1));
    file_.add_ints("ns_prop1", num_sets, ids, {{"name", "ID"}});
    file_.add_texts("ns_names", num_sets, name_bytes, node_set_names_);
    for (std::size_t line = 0; line < node_set_names_.size(); ++line) {
      std::vector<std::int32_t> nodes;
      for (const std::uint32_t vertex : vertices_of_line(sets_, mesh_.lines, line))
        nodes.push_back(static_cast<std::int32_t>(vertex + 1));
      const Dimension num_nodes = file_.add_dimension(fmt::format("num_nod_ns{}", line + 1), nodes.size());
      file_.add_ints(fmt::format("node_ns{}", line + 1), num_nodes, std::move(nodes));
    }
  }

  // Returns the number of a cell, from 1, in the order of the blocks.
  std::uint32_t element_of(std::uint32_t cell) const {
    const auto block = static_cast<std::size_t>(
        std::lower_bound(sets_.volumes.begin(), sets_.volumes.end(), mesh_.cell_labels[cell]) -
        sets_.volumes.begin());
    const auto cells = sets_.cells_of_label[mesh_.cell_labels[cell]];
    const auto position =
        static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin());
    return static_cast<std::uint32_t>(first_element_[block] + position + 1);
  }

  const TetMesh& mesh_;
  const MeshSets sets_;
  const std::vector<FacetSide> sides_;
  std::vector<std::size_t> first_element_;  // of each block
  std::vector<SideSet> side_sets_;          // of pairs, then of sides of a flat box
  std::vector<std::string> block_names_, side_set_names_, node_set_names_;
  std::size_t longest_name_ = kShortName;
  Losses losses_;
  NetcdfFile file_;
};

}  // namespace

Losses write_exodus(const TetMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  ExodusWriter writer(mesh);
  writer.check_size(path);
  Losses losses = writer.write(file);
  file.publish();
  return losses;
}

}  // namespace podm
