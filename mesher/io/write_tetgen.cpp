// TetGen's .node, .ele and .face, which together are one mesh. The attribute of a tetrahedron is its label
// value. The marker of a face numbers its label pair, on a side of a flat box the pair there. Comments at the
// ends of .ele and .face name labels and pairs. Numbers count from 1. Format: TetGen's manual, "File
// formats".
#include <deque>
#include <filesystem>

#include "files/atomic_file.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/promises.h"
#include "io/text_file.h"

namespace podm {
namespace {

void write_nodes(const TetMesh& mesh, AtomicFile& file) {
  TextFile text(file);
  text.print(FMT_COMPILE("# space {}\n"), to_string(mesh.space));
  for (const std::string& promise : promises_of(mesh)) text.print(FMT_COMPILE("# promise {}\n"), promise);
  text.print(FMT_COMPILE("{} 3 0 0\n"), mesh.vertices.size());  // dimension, attributes, markers
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& [x, y, z] = mesh.vertices[i];
    text.print(FMT_COMPILE("{} {} {} {}\n"), i + 1, x, y, z);
  }
  text.flush();
}

void write_elements(const TetMesh& mesh, const LabelNames& names, AtomicFile& file) {
  TextFile text(file);
  text.print(FMT_COMPILE("{} 4 1\n"), mesh.cells.size());  // nodes, attributes
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const auto& [a, b, c, d] = mesh.cells[i];
    const std::uint32_t label = mesh.labels[mesh.cell_labels[i]].value;
    text.print(FMT_COMPILE("{} {} {} {} {} {}\n"), i + 1, a + 1, b + 1, c + 1, d + 1, label);
  }
  for (std::size_t i = 1; i < mesh.labels.size(); ++i)
    text.print(FMT_COMPILE("# label {} {}\n"), mesh.labels[i].value, names[static_cast<LabelIndex>(i)]);
  text.flush();
}

void write_faces(const TetMesh& mesh, const FacetPatches& sets, AtomicFile& file) {
  TextFile text(file);
  text.print(FMT_COMPILE("{} 1\n"), mesh.facets.size());  // markers
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.facets[i];
    text.print(FMT_COMPILE("{} {} {} {} {}\n"), i + 1, a + 1, b + 1, c + 1, sets.patch_of(mesh, i) + 1);
  }
  for (std::size_t i = 0; i < sets.patches.size(); ++i) {
    const auto [a, b] = sets.pairs[sets.patches[i].pair];
    text.print(FMT_COMPILE("# pair {} {} {} {}\n"), i + 1, mesh.labels[a].value, mesh.labels[b].value,
               sets.name_of(sets.patches[i]));
  }
  text.flush();
}

}  // namespace

void write_tetgen(const TetMesh& mesh, const std::string& path) {
  const auto beside = [&path](const char* extension) {
    return std::filesystem::path(path).replace_extension(extension).string();
  };
  const FacetPatches sets(mesh);
  std::deque<AtomicFile> files;
  for (const char* extension : {".node", ".ele", ".face"}) files.emplace_back(beside(extension));
  write_nodes(mesh, files[0]);
  write_elements(mesh, sets.names, files[1]);
  write_faces(mesh, sets, files[2]);
  publish_together(files);
}

}  // namespace podm
