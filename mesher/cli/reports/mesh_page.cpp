#include "cli/reports/mesh_page.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/processes/python_scripts.h"
#include "cli/reports/json_text.h"
#include "cli/reports/record.h"
#include "files/atomic_file.h"
#include "files/temporary_file.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"

namespace podm::cli {
namespace {

constexpr const char* kScript = "mesh_report";
constexpr const char* kAskedBy = "--report";

std::string output_of_script(const std::string& request, const SignalThread& signals) {
  ScriptResult result = run_script(kScript, request, kAskedBy, signals);
  if (signals.token().stop_requested()) throw InputError("--report: omitted, because a signal ended the run");
  if (result.exit_code != 0) throw InputError("--report: the page could not be made");
  return std::move(result.output);
}

}  // namespace

void check_page(const MeshCommand& command, const SignalThread& signals) {
  if (!command.page_path.ends_with(".html"))
    throw InputError(fmt::format("--report: '{}' does not end in .html", command.page_path));
  const AtomicFile trial(command.page_path);
  output_of_script("--check", signals);
}

void write_page(const MeshRun& run, const TetMesh& mesh, const SignalThread& signals) try {
  const std::string& path = run.command.page_path;
  const std::filesystem::path mesh_path = run.command.mesh_path;
  const TemporaryFolder scratch(path);
  const std::string readable = mesh_path.extension() == ".vtu" ? mesh_path.string() : scratch / "mesh.vtu";
  if (readable != mesh_path) write_mesh(mesh, readable);
  const std::string request = scratch / "request.json";
  AtomicFile request_file(request);
  request_file.write(
      json_line({{"mesh", readable},
                 {"name", mesh_path.filename().string()},
                 {"record", record(run)},
                 {"verification", run.verification ? *run.verification : nlohmann::ordered_json()},
                 {"unmet", run.unmet()}}));
  request_file.publish();
  AtomicFile page(path);
  page.write(output_of_script(request, signals));
  page.publish();
} catch (const InputError& error) {
  throw InputError(fmt::format("{}; {} is written", error.what(), run.command.mesh_path));
}

}  // namespace podm::cli
