// Gmsh MSH 4.1, binary. Every label is a volume, every label pair a surface and every line a curve. Each is a
// discrete entity with a physical group of the same name. With a flat box, the part of a surface on a side is
// an entity of its own, which is in the groups of the pair and of the side ("box i-"). Elements and nodes are
// stored in one block per entity.
//
// Tags: the tag of a volume entity is its position in TetMesh::labels, and its physical group is the label
// value (for all volumes the position, if one value is not a positive int). The tag of a surface entity is
// the number of its patch, that of its group the number of the pair. The tag of a curve and of its group is
// the number of the line. Node tags are vertex positions plus one.
// Format: Gmsh reference manual, "MSH file format".
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include "files/atomic_file.h"
#include "io/grouping.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/promises.h"

namespace podm {
namespace {

static_assert(std::endian::native == std::endian::little,
              "Gmsh's byte order mark is written as little-endian");

constexpr int kGmshLine = 1, kGmshTriangle = 2, kGmshTetrahedron = 4;  // element types
constexpr std::int32_t kCurveDimension = 1, kSurfaceDimension = 2, kVolumeDimension = 3;

struct Box {
  std::array<double, 3> low, high;
  Box() {
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
  }
  void include(const std::array<double, 3>& point) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
};

class GmshWriter {
 public:
  GmshWriter(const TetMesh& mesh, AtomicFile& file) : mesh_(mesh), file_(file), sets_(mesh) {}

  void write() {
    write_format();
    write_comments();
    write_physical_names();
    write_entities();
    write_nodes();
    write_elements();
  }

 private:
  static std::int32_t surface_tag(std::size_t pair) { return MeshSets::surface_tag(pair); }
  std::int32_t physical_tag(LabelIndex label) const { return sets_.volume_tags[label]; }

  void write_format() {
    file_.write("$MeshFormat\n4.1 1 8\n");  // version, binary, bytes of a size
    file_.put(std::int32_t{1});             // shows the byte order
    file_.write("\n$EndMeshFormat\n");
  }

  void write_comments() {
    file_.write(fmt::format("$Comments\nspace {}\n", to_string(mesh_.space)));
    for (const std::string& promise : promises_of(mesh_)) file_.write(fmt::format("promise {}\n", promise));
    for (const LabelIndex label : sets_.volumes) {
      file_.write(fmt::format("label {} physical volume {} {}\n", mesh_.labels[label].value,
                              physical_tag(label), sets_.names[label]));
    }
    file_.write("$EndComments\n");
  }

  void write_physical_names() {
    const std::size_t num_groups =
        num_lines() + sets_.pairs.size() + sets_.sides.size() + sets_.volumes.size();
    file_.write(fmt::format("$PhysicalNames\n{}\n", num_groups));
    for (std::size_t line = 0; line < num_lines(); ++line) {
      file_.write(
          fmt::format("{} {} \"{}\"\n", kCurveDimension, MeshSets::line_tag(line), sets_.line_names[line]));
    }
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
      file_.write(fmt::format("{} {} \"{}\"\n", kSurfaceDimension, surface_tag(i),
                              sets_.names.of_pair(sets_.pairs[i])));
    }
    for (const std::size_t side : sets_.sides)
      file_.write(fmt::format("{} {} \"{}\"\n", kSurfaceDimension, sets_.side_tag(side), name_of_side(side)));
    for (const LabelIndex label : sets_.volumes) {
      file_.write(fmt::format("{} {} \"{}\"\n", kVolumeDimension, physical_tag(label), sets_.names[label]));
    }
    file_.write("$EndPhysicalNames\n");
  }

  std::size_t num_lines() const { return sets_.line_names.size(); }
  std::size_t num_entities() const { return num_lines() + sets_.patches.size() + sets_.volumes.size(); }
  void put_size(std::size_t size) { file_.put(std::uint64_t{size}); }

  void write_entities() {
    file_.write("$Entities\n");
    for (const std::size_t count : {std::size_t{0}, num_lines(), sets_.patches.size(), sets_.volumes.size()})
      put_size(count);
    for (std::size_t line = 0; line < num_lines(); ++line) {
      Box box;
      for (const std::uint32_t edge : sets_.edges_of_line[line])
        for (const std::uint32_t vertex : mesh_.lines.edges[edge]) box.include(mesh_.vertices[vertex]);
      put_entity(MeshSets::line_tag(line), box, {MeshSets::line_tag(line)}, {});
    }
    std::vector<Box> volume_boxes(mesh_.labels.size());  // boxes of its surfaces, which close the volume
    for (std::size_t i = 0; i < sets_.patches.size(); ++i) {
      Box box;
      for (const std::uint32_t facet : sets_.facets_of_patch[i])
        for (const std::uint32_t vertex : mesh_.facets[facet]) box.include(mesh_.vertices[vertex]);
      for (const LabelIndex label : pair_of_patch(i)) {
        volume_boxes[label].include(box.low);
        volume_boxes[label].include(box.high);
      }
      put_entity(surface_tag(i), box, groups_of_patch(i), {});
    }
    for (const LabelIndex label : sets_.volumes) {
      std::vector<std::int32_t> signed_surfaces;  // positive if the normal points out of the volume
      for (std::size_t i = 0; i < sets_.patches.size(); ++i) {
        if (pair_of_patch(i)[1] == label) signed_surfaces.push_back(surface_tag(i));
        if (pair_of_patch(i)[0] == label) signed_surfaces.push_back(-surface_tag(i));
      }
      put_entity(label, volume_boxes[label], {physical_tag(label)}, signed_surfaces);
    }
    file_.write("\n$EndEntities\n");
  }

  const LabelPair& pair_of_patch(std::size_t i) const { return sets_.pairs[sets_.patches[i].pair]; }
  std::vector<std::int32_t> groups_of_patch(std::size_t i) const {
    const auto [pair, side] = sets_.patches[i];
    std::vector<std::int32_t> groups{surface_tag(pair)};
    if (side != 0) groups.push_back(sets_.side_tag(static_cast<std::size_t>(std::countr_zero(side))));
    return groups;
  }

  void put_entity(std::int32_t tag, const Box& box, const std::vector<std::int32_t>& physical,
                  const std::vector<std::int32_t>& boundary) {
    file_.put(tag);
    file_.put(box.low);
    file_.put(box.high);
    put_size(physical.size());
    for (const std::int32_t group : physical) file_.put(group);
    put_size(boundary.size());
    for (const std::int32_t surface : boundary) file_.put(surface);
  }

  // Assigns a vertex to the first curve through it, otherwise to the first surface, otherwise to the volume
  // around it.
  Grouping group_vertices() const {
    // Groups: lines, then surfaces, then labels.
    const auto first_surface = static_cast<std::uint32_t>(num_lines());
    const auto first_volume = static_cast<std::uint32_t>(num_lines() + sets_.patches.size());
    std::vector<std::uint32_t> group(mesh_.vertices.size(), first_volume);
    for (std::size_t i = 0; i < mesh_.cells.size(); ++i)
      for (const std::uint32_t vertex : mesh_.cells[i]) group[vertex] = first_volume + mesh_.cell_labels[i];
    for (std::uint32_t patch = 0; patch < sets_.patches.size(); ++patch)
      for (const std::uint32_t facet : sets_.facets_of_patch[patch])
        for (const std::uint32_t vertex : mesh_.facets[facet])
          group[vertex] = std::min(group[vertex], first_surface + patch);
    for (std::size_t edge = 0; edge < mesh_.lines.edges.size(); ++edge)
      for (const std::uint32_t vertex : mesh_.lines.edges[edge])
        group[vertex] = std::min(group[vertex], mesh_.lines.line_of_edge[edge]);
    return Grouping(group.size(), first_volume + mesh_.labels.size(),
                    [&](std::size_t v) { return group[v]; });
  }

  void write_nodes() {
    const Grouping groups = group_vertices();
    std::size_t num_blocks = 0;
    for (std::size_t g = 0; g < groups.num_groups(); ++g) num_blocks += !groups[g].empty();
    file_.write("$Nodes\n");
    put_section_head(num_blocks, mesh_.vertices.size());
    for (std::size_t g = 0; g < groups.num_groups(); ++g) {
      if (groups[g].empty()) continue;
      put_entity_of_group(g);
      file_.put(std::int32_t{0});  // no parametric coordinates
      put_size(groups[g].size());
      for (const std::uint32_t vertex : groups[g]) put_size(std::size_t{vertex} + 1);
      for (const std::uint32_t vertex : groups[g]) file_.put(mesh_.vertices[vertex]);
    }
    file_.write("\n$EndNodes\n");
  }

  // Puts the dimension and the tag of an entity.
  void put_entity_of_group(std::size_t group) {
    const std::size_t first_surface = num_lines(), first_volume = first_surface + sets_.patches.size();
    if (group < first_surface) {
      file_.put(kCurveDimension);
      file_.put(MeshSets::line_tag(group));
    } else if (group < first_volume) {
      file_.put(kSurfaceDimension);
      file_.put(surface_tag(group - first_surface));
    } else {
      file_.put(kVolumeDimension);
      file_.put(static_cast<std::int32_t>(group - first_volume));
    }
  }

  void write_elements() {
    file_.write("$Elements\n");
    put_section_head(num_entities(), mesh_.facets.size() + mesh_.cells.size() + mesh_.lines.edges.size());
    for (std::size_t i = 0; i < sets_.patches.size(); ++i)
      put_elements(kSurfaceDimension, surface_tag(i), kGmshTriangle, sets_.facets_of_patch[i], mesh_.facets,
                   1);
    for (const LabelIndex label : sets_.volumes) {
      put_elements(kVolumeDimension, label, kGmshTetrahedron, sets_.cells_of_label[label], mesh_.cells,
                   mesh_.facets.size() + 1);
    }
    for (std::size_t line = 0; line < num_lines(); ++line) {
      put_elements(kCurveDimension, MeshSets::line_tag(line), kGmshLine, sets_.edges_of_line[line],
                   mesh_.lines.edges, mesh_.facets.size() + mesh_.cells.size() + 1);
    }
    file_.write("\n$EndElements\n");
  }

  // Tags of nodes and of elements run from 1 without a gap.
  void put_section_head(std::size_t num_blocks, std::size_t num_items) {
    for (const std::size_t size : {num_blocks, num_items, std::min(num_items, std::size_t{1}), num_items})
      put_size(size);
  }

  template <std::size_t N>
  void put_elements(std::int32_t dimension, std::int32_t entity, std::int32_t type,
                    std::span<const std::uint32_t> members,
                    const std::vector<std::array<std::uint32_t, N>>& elements, std::size_t first_tag) {
    file_.put(dimension);
    file_.put(entity);
    file_.put(type);
    put_size(members.size());
    for (const std::uint32_t member : members) {
      std::array<std::uint64_t, N + 1> element{first_tag + member};
      for (std::size_t i = 0; i < N; ++i) element[i + 1] = std::uint64_t{elements[member][i]} + 1;
      file_.put(element);
    }
  }

  const TetMesh& mesh_;
  AtomicFile& file_;
  const MeshSets sets_;
};

}  // namespace

void write_gmsh(const TetMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  GmshWriter(mesh, file).write();
  file.publish();
}

}  // namespace podm
