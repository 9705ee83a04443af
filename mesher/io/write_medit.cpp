// Medit (.mesh) ascii. The reference of a tetrahedron is its label value; that of a triangle numbers its
// label pair, that of an edge its line. A triangle has one reference: the facets of a pair on a side of a
// flat box have a number of their own.
#include "files/atomic_file.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/promises.h"
#include "io/text_file.h"

namespace podm {
namespace {

void print_comments(TextFile& text, const TetMesh& mesh, const FacetPatches& sets) {
  text.print(FMT_COMPILE("# space {}\n"), to_string(mesh.space));
  for (const std::string& promise : promises_of(mesh)) text.print(FMT_COMPILE("# promise {}\n"), promise);
  text.print(FMT_COMPILE("# tetrahedron reference: label value\n"));
  for (std::size_t i = 1; i < mesh.labels.size(); ++i)
    text.print(FMT_COMPILE("# label {} {}\n"), mesh.labels[i].value, sets.names[static_cast<LabelIndex>(i)]);
  text.print(
      FMT_COMPILE(
          "# triangle reference: pair of label values (outside: {}), the normal points to the first\n"),
      mesh.labels[kBackground].value);
  for (std::size_t i = 0; i < sets.patches.size(); ++i) {
    const auto [a, b] = sets.pairs[sets.patches[i].pair];
    text.print(FMT_COMPILE("# pair {} {} {} {}\n"), i + 1, mesh.labels[a].value, mesh.labels[b].value,
               sets.name_of(sets.patches[i]));
  }
  const auto& lines = mesh.lines.labels_of_line;
  for (std::size_t i = 0; i < lines.size(); ++i)
    text.print(FMT_COMPILE("# line {} {}\n"), i + 1, sets.names.of_line(lines[i]));
}

// Files without lines have no such section.
void print_edges(TextFile& text, const MeshLines& lines) {
  if (lines.edges.empty()) return;
  text.print(FMT_COMPILE("Edges\n{}\n"), lines.edges.size());
  for (std::size_t i = 0; i < lines.edges.size(); ++i)
    text.print(FMT_COMPILE("{} {} {}\n"), lines.edges[i][0] + 1, lines.edges[i][1] + 1,
               lines.line_of_edge[i] + 1);
}

}  // namespace

void write_medit(const TetMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  TextFile text(file);
  const FacetPatches sets(mesh);
  text.print(FMT_COMPILE("MeshVersionFormatted 2\n"));  // 2: doubles
  print_comments(text, mesh, sets);
  text.print(FMT_COMPILE("Dimension 3\nVertices\n{}\n"), mesh.vertices.size());
  for (const auto& [x, y, z] : mesh.vertices) text.print(FMT_COMPILE("{} {} {} 0\n"), x, y, z);
  print_edges(text, mesh.lines);
  text.print(FMT_COMPILE("Triangles\n{}\n"), mesh.facets.size());
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.facets[i];
    text.print(FMT_COMPILE("{} {} {} {}\n"), a + 1, b + 1, c + 1, sets.patch_of(mesh, i) + 1);
  }
  text.print(FMT_COMPILE("Tetrahedra\n{}\n"), mesh.cells.size());
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto& [a, b, c, d] = mesh.cells[i];
    const std::uint32_t reference = mesh.labels[mesh.cell_labels[i]].value;
    text.print(FMT_COMPILE("{} {} {} {} {}\n"), a + 1, b + 1, c + 1, d + 1, reference);
  }
  text.print(FMT_COMPILE("End\n"));
  text.flush();
  file.publish();
}

}  // namespace podm
