// podm view: this process becomes the script that draws, on a display of its own that nobody sees.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <nlohmann/json.hpp>
#include <system_error>

#include "cli/commands.h"
#include "cli/json_text.h"
#include "cli/python_scripts.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

constexpr const char* kWithDisplay = "/usr/bin/xvfb-run";  // Debian's VTK draws through X alone

nlohmann::ordered_json request(const ViewCommand& command) {
  nlohmann::ordered_json cut = nullptr;
  if (command.cut)
    cut = {{"normal", command.cut->normal},
           {"place", command.cut->place},
           {"is_fraction", command.cut->is_fraction}};
  return {{"mesh", command.mesh_path},
          {"output", command.output_path},
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
  std::vector<std::string> words{kWithDisplay, "-a"};
  for (std::string& word : script_command("view", "view")) words.push_back(std::move(word));
  words.push_back(json_line(request(command)));
  if (::access(kWithDisplay, X_OK) != 0)
    throw InputError(fmt::format("view: {} is not there; install Debian's xvfb and xauth", kWithDisplay));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::signal(SIGXFSZ, SIG_DFL);
  std::signal(SIGPIPE, SIG_DFL);
  ::execv(arguments[0], arguments.data());
  throw InputError(
      fmt::format("view: {} cannot be run: {}", kWithDisplay, std::generic_category().message(errno)));
}

}  // namespace podm::cli
