// Gmsh MSH 2.2, text, for FreeFem++, SfePy, dolfin-convert and other programs that cannot read 4.1. Every
// element has two tags, its physical group and its entity, which are equal here. Groups are those of the 4.1
// file, except that the facets of a pair of labels on a side of a flat box are a group of their own: an
// element is in one group here. Comments list the pair of labels that each group of triangles separates.
// Format: Gmsh reference manual, "MSH file format version 2 (Legacy)".
#include "files/atomic_file.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/promises.h"
#include "io/text_file.h"

namespace podm {
namespace {

void print_comments(TextFile& text, const TetMesh& mesh, const MeshSets& sets) {
  text.print(FMT_COMPILE("$Comments\nspace {}\n"), to_string(mesh.space));
  for (const std::string& promise : promises_of(mesh)) text.print(FMT_COMPILE("promise {}\n"), promise);
  for (const LabelIndex label : sets.volumes)
    text.print(FMT_COMPILE("label {} physical volume {} {}\n"), mesh.labels[label].value,
               sets.volume_tags[label], sets.names[label]);
  for (std::size_t i = 0; i < sets.patches.size(); ++i) {
    const auto [a, b] = sets.pairs[sets.patches[i].pair];
    text.print(FMT_COMPILE("pair {} {} physical surface {}\n"), mesh.labels[a].value, mesh.labels[b].value,
               MeshSets::surface_tag(i));
  }
  text.put("$EndComments\n");
}

void print_names(TextFile& text, const MeshSets& sets) {
  text.print(FMT_COMPILE("$PhysicalNames\n{}\n"),
             sets.line_names.size() + sets.patches.size() + sets.volumes.size());
  for (std::size_t line = 0; line < sets.line_names.size(); ++line)
    text.print(FMT_COMPILE("1 {} \"{}\"\n"), MeshSets::line_tag(line), sets.line_names[line]);
  for (std::size_t i = 0; i < sets.patches.size(); ++i)
    text.print(FMT_COMPILE("2 {} \"{}\"\n"), MeshSets::surface_tag(i), sets.name_of(sets.patches[i]));
  for (const LabelIndex label : sets.volumes)
    text.print(FMT_COMPILE("3 {} \"{}\"\n"), sets.volume_tags[label], sets.names[label]);
  text.put("$EndPhysicalNames\n");
}

void print_nodes(TextFile& text, const TetMesh& mesh) {
  text.print(FMT_COMPILE("$Nodes\n{}\n"), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& [x, y, z] = mesh.vertices[i];
    text.print(FMT_COMPILE("{} {} {} {}\n"), i + 1, x, y, z);
  }
  text.put("$EndNodes\n");
}

void print_elements(TextFile& text, const TetMesh& mesh, const MeshSets& sets) {
  const std::size_t first_edge = mesh.facets.size() + mesh.cells.size() + 1;
  text.print(FMT_COMPILE("$Elements\n{}\n"), first_edge - 1 + mesh.lines.edges.size());
  std::vector<std::int32_t> tags(mesh.facets.size());
  for (std::size_t patch = 0; patch < sets.patches.size(); ++patch)
    for (const std::uint32_t facet : sets.facets_of_patch[patch]) tags[facet] = MeshSets::surface_tag(patch);
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.facets[i];
    const std::int32_t tag = tags[i];
    text.print(FMT_COMPILE("{} 2 2 {} {} {} {} {}\n"), i + 1, tag, tag, a + 1, b + 1, c + 1);
  }
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto& [a, b, c, d] = mesh.cells[i];
    const std::int32_t tag = sets.volume_tags[mesh.cell_labels[i]];
    text.print(FMT_COMPILE("{} 4 2 {} {} {} {} {} {}\n"), mesh.facets.size() + i + 1, tag, tag, a + 1, b + 1,
               c + 1, d + 1);
  }
  for (std::size_t i = 0; i < mesh.lines.edges.size(); ++i) {
    const auto& [a, b] = mesh.lines.edges[i];
    const std::int32_t tag = MeshSets::line_tag(mesh.lines.line_of_edge[i]);
    text.print(FMT_COMPILE("{} 1 2 {} {} {} {}\n"), first_edge + i, tag, tag, a + 1, b + 1);
  }
  text.put("$EndElements\n");
}

}  // namespace

void write_gmsh_v2(const TetMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  TextFile text(file);
  const MeshSets sets(mesh);
  text.put("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");  // version, text, bytes of a real
  print_comments(text, mesh, sets);
  print_names(text, sets);
  print_nodes(text, mesh);
  print_elements(text, mesh, sets);
  text.flush();
  file.publish();
}

}  // namespace podm
