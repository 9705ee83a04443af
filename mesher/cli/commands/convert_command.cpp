// podm convert: reads a mesh file of any format that podm-verify reads, and writes it, or the surfaces of its
// labels, in a format of podm.
#include <fmt/format.h>

#include <cstdio>

#include "cli/commands/commands.h"
#include "cli/commands/foreign_mesh.h"
#include "cli/processes/signal_thread.h"
#include "podm/mesh_io.h"

namespace podm::cli {

int run(const ConvertCommand& command) {
  const SignalThread signals;  // leaves no partial mesh behind
  const bool is_surface = is_surface_path(command.output_path) && !command.mesh_file.gmsh_version;
  is_surface ? check_surface_path(command.output_path)
             : check_mesh_path(command.output_path, command.mesh_file);
  ForeignMesh foreign = read_foreign_mesh(command.input_path);
  TetMesh& mesh = foreign.mesh;
  canonicalize(mesh);
  if (is_surface) {
    write_surfaces(mesh, command.output_path);
  } else {
    for (const std::string& loss : write_mesh(mesh, command.output_path, command.mesh_file))
      foreign.warnings.push_back(command.output_path + ": " + loss);
  }
  for (const std::string& warning : foreign.warnings) fmt::print(stderr, "warning: {}\n", warning);
  fmt::print(stderr, "{}: {} cells of {} labels, {} vertices, {} facets, from {}\n", command.output_path,
             mesh.cells.size(), mesh.labels.size() - 1, mesh.vertices.size(), mesh.facets.size(),
             foreign.format);
  return 0;
}

}  // namespace podm::cli
