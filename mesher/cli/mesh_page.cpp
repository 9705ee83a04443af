#include "cli/mesh_page.h"

#include <fmt/format.h>

#include "cli/child_process.h"
#include "cli/json_text.h"
#include "cli/python_scripts.h"
#include "cli/record.h"
#include "files/atomic_file.h"
#include "files/temporary_file.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

constexpr const char* kScript = "mesh_report";
constexpr const char* kAskedBy = "--report";

// What the script tells on standard output; it says itself, on standard error, why it fails.
std::string told_by_script(const std::string& request, const SignalThread& signals) {
  auto command = script_command(kScript, kAskedBy);
  command.push_back(request);
  ChildProcess script(command, kAskedBy, signals);
  std::string text = script.read(signals);
  if (signals.token().stop_requested()) throw InputError("--report: left out, as a signal asked for the end");
  if (script.exit_code() != 0) throw InputError("--report: no page can be made");
  return text;
}

}  // namespace

void check_page(const MeshCommand& command, const SignalThread& signals) {
  if (command.mesh_path.ends_with(".xdmf"))
    throw InputError(
        fmt::format("--report: no page is made of {}, but of .vtu, .mesh and .msh files", command.mesh_path));
  if (!command.page_path.ends_with(".html"))
    throw InputError(fmt::format("--report: '{}' does not end in .html", command.page_path));
  const AtomicFile trial(command.page_path);
  told_by_script("--check", signals);
}

void write_page(const MeshRun& run, const SignalThread& signals) try {
  const std::string& path = run.command.page_path;
  const TemporaryFolder scratch(path);
  const std::string request = scratch / "request.json";
  AtomicFile told(request);
  told.write(json_line({{"mesh", run.command.mesh_path},
                        {"record", record(run)},
                        {"verification", run.verification},
                        {"unmet", run.unmet()}}));
  told.publish();
  AtomicFile page(path);
  page.write(told_by_script(request, signals));
  page.publish();
} catch (const InputError& error) {
  throw InputError(fmt::format("{}; {} is written", error.what(), run.command.mesh_path));
}

}  // namespace podm::cli
