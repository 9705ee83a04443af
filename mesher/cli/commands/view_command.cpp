// podm view: runs a script that draws off screen.
#include <nlohmann/json.hpp>

#include "cli/commands/commands.h"
#include "cli/commands/foreign_mesh.h"
#include "cli/processes/python_scripts.h"
#include "cli/reports/json_text.h"
#include "files/atomic_file.h"
#include "files/temporary_file.h"
#include "podm/mesh_io.h"

namespace podm::cli {
namespace {

constexpr int kInternalError = 3;

bool is_of_vtk(const std::string& path) {
  return path.ends_with(".vtu") || path.ends_with(".pvtu") || path.ends_with(".vtk");
}

// Returns a file that the script can read: the mesh itself, or a copy.
std::string readable_mesh(const std::string& path, const TemporaryFolder& scratch) {
  if (is_of_vtk(path)) return path;
  ForeignMesh foreign = read_foreign_mesh(path);
  canonicalize(foreign.mesh);
  std::string copy = scratch / "mesh.vtu";
  write_mesh(foreign.mesh, copy);
  return copy;
}

nlohmann::ordered_json request(const ViewCommand& command, const std::string& mesh) {
  nlohmann::ordered_json cut = nullptr;
  if (command.cut)
    cut = {{"normal", command.cut->normal},
           {"place", command.cut->place},
           {"is_fraction", command.cut->is_fraction}};
  return {{"mesh", mesh},
          {"cut", cut},
          {"flip", command.flip},
          {"labels", command.labels},
          {"hide", command.hide},
          {"colour", to_string(command.colour)},
          {"camera_deg", command.camera_deg},
          {"zoom", command.zoom},
          {"size", command.size},
          {"background", command.background},
          {"legend", !command.without_legend}};
}

}  // namespace

int run(const ViewCommand& command) {
  const SignalThread signals;  // leaves no process and no partial picture behind
  AtomicFile picture(command.output_path);
  const TemporaryFolder scratch(command.output_path);
  const std::string mesh = readable_mesh(command.mesh_path, scratch);
  const ScriptResult drawn = run_script("view", json_line(request(command, mesh)), "view", signals);
  if (drawn.exit_code != 0) return drawn.exit_code == 2 ? 2 : kInternalError;
  picture.write(drawn.output);
  picture.publish();
  return 0;
}

}  // namespace podm::cli
