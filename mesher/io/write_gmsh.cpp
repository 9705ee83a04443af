// Gmsh MSH 4.1, binary. Every label is a volume and every label pair a surface. Each is a discrete entity
// with a physical group of the same name. Elements and nodes are stored in one block per entity.
//
// Tags: the tag of a volume entity is its position in TetMesh::labels, and its physical group is the label
// value (for all volumes the position, if one value is not a positive int). The tag of a surface entity and
// of its group is the number of the pair. Node tags are vertex positions plus one. Format: Gmsh reference
// manual, "MSH file format".
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

constexpr int kGmshTriangle = 2, kGmshTetrahedron = 4;  // element types
constexpr std::int32_t kSurfaceDimension = 2, kVolumeDimension = 3;

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
    file_.write(fmt::format("$PhysicalNames\n{}\n", sets_.pairs.size() + sets_.volumes.size()));
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
      file_.write(fmt::format("{} {} \"{}\"\n", kSurfaceDimension, surface_tag(i),
                              sets_.names.of_pair(sets_.pairs[i])));
    }
    for (const LabelIndex label : sets_.volumes) {
      file_.write(fmt::format("{} {} \"{}\"\n", kVolumeDimension, physical_tag(label), sets_.names[label]));
    }
    file_.write("$EndPhysicalNames\n");
  }

  void put_size(std::size_t size) { file_.put(std::uint64_t{size}); }

  void write_entities() {
    file_.write("$Entities\n");
    for (const std::size_t count : {std::size_t{0}, std::size_t{0}, sets_.pairs.size(), sets_.volumes.size()})
      put_size(count);
    std::vector<Box> volume_boxes(mesh_.labels.size());  // boxes of its surfaces, which close the volume
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
      Box box;
      for (const std::uint32_t facet : sets_.facets_of_pair[i])
        for (const std::uint32_t vertex : mesh_.facets[facet]) box.include(mesh_.vertices[vertex]);
      for (const LabelIndex label : sets_.pairs[i]) {
        volume_boxes[label].include(box.low);
        volume_boxes[label].include(box.high);
      }
      put_entity(surface_tag(i), box, surface_tag(i), {});
    }
    for (const LabelIndex label : sets_.volumes) {
      std::vector<std::int32_t> signed_surfaces;  // positive if the normal points out of the volume
      for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
        if (sets_.pairs[i][1] == label) signed_surfaces.push_back(surface_tag(i));
        if (sets_.pairs[i][0] == label) signed_surfaces.push_back(-surface_tag(i));
      }
      put_entity(label, volume_boxes[label], physical_tag(label), signed_surfaces);
    }
    file_.write("\n$EndEntities\n");
  }

  void put_entity(std::int32_t tag, const Box& box, std::int32_t physical,
                  const std::vector<std::int32_t>& boundary) {
    file_.put(tag);
    file_.put(box.low);
    file_.put(box.high);
    put_size(1);
    file_.put(physical);
    put_size(boundary.size());
    for (const std::int32_t surface : boundary) file_.put(surface);
  }

  // Assigns a vertex to the first surface through it, otherwise to the volume around it.
  Grouping group_vertices() const {
    // Groups: surfaces, then labels.
    const auto first_volume = static_cast<std::uint32_t>(sets_.pairs.size());
    std::vector<std::uint32_t> group(mesh_.vertices.size(), first_volume);
    for (std::size_t i = 0; i < mesh_.cells.size(); ++i)
      for (const std::uint32_t vertex : mesh_.cells[i]) group[vertex] = first_volume + mesh_.cell_labels[i];
    for (std::uint32_t pair = 0; pair < first_volume; ++pair)
      for (const std::uint32_t facet : sets_.facets_of_pair[pair])
        for (const std::uint32_t vertex : mesh_.facets[facet]) group[vertex] = std::min(group[vertex], pair);
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
      const bool on_surface = g < sets_.pairs.size();
      file_.put(on_surface ? kSurfaceDimension : kVolumeDimension);
      file_.put(on_surface ? surface_tag(g) : static_cast<std::int32_t>(g - sets_.pairs.size()));
      file_.put(std::int32_t{0});  // no parametric coordinates
      put_size(groups[g].size());
      for (const std::uint32_t vertex : groups[g]) put_size(std::size_t{vertex} + 1);
      for (const std::uint32_t vertex : groups[g]) file_.put(mesh_.vertices[vertex]);
    }
    file_.write("\n$EndNodes\n");
  }

  void write_elements() {
    file_.write("$Elements\n");
    put_section_head(sets_.pairs.size() + sets_.volumes.size(), mesh_.facets.size() + mesh_.cells.size());
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i)
      put_elements(kSurfaceDimension, surface_tag(i), kGmshTriangle, sets_.facets_of_pair[i], mesh_.facets,
                   1);
    for (const LabelIndex label : sets_.volumes) {
      put_elements(kVolumeDimension, label, kGmshTetrahedron, sets_.cells_of_label[label], mesh_.cells,
                   mesh_.facets.size() + 1);
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
