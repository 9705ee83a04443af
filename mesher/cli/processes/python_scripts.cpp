#include "cli/processes/python_scripts.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <vector>

#include "cli/processes/child_process.h"
#include "cli/processes/own_program.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

// Returns the interpreter. By default it is the one that finds Debian's modules. The variable is set by the
// programs that pip installs, and names the interpreter that finds pip's modules.
std::string python() {
  const char* const chosen = std::getenv("PODM_PYTHON");
  return chosen != nullptr ? chosen : "/usr/bin/python3";
}

std::vector<std::string> script_command(const std::string& script, const std::string& asked_by) {
  const auto folder = folder_of_own_program().parent_path();
  const std::string path = (folder / PODM_SHARE / script).string();
  if (!can_be_run(python()))
    throw InputError(
        fmt::format("{}: {} is missing; install Debian's python3, or set PODM_PYTHON", asked_by, python()));
  if (::access(path.c_str(), R_OK) != 0)
    throw InputError(
        fmt::format("{}: {} is missing; the installation of podm is incomplete", asked_by, path));
  // Modules that pip installed for this user only are a user's own choice.
  std::vector<std::string> command{python(), "-E", "-B"};
  if (std::getenv("PODM_PYTHON") == nullptr) command.emplace_back("-s");
  command.push_back(path);
  return command;
}

}  // namespace

ScriptResult run_script(const std::string& script, const std::string& argument, const std::string& asked_by,
                        const SignalThread& signals) {
  std::vector<std::string> command = script_command(script, asked_by);
  command.push_back(argument);
  ChildProcess process(command, asked_by, signals);
  std::string output = process.read(signals);
  return {std::move(output), process.exit_code()};
}

void become_script(const std::string& script, const std::string& argument, const std::string& asked_by) {
  std::vector<std::string> command = script_command(script, asked_by);
  command.push_back(argument);
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  throw InputError(fmt::format("{}: {} cannot be run", asked_by, command[0]));
}

}  // namespace podm::cli
