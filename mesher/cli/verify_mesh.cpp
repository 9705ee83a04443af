#include "cli/verify_mesh.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "files/leftovers.h"
#include "podm/errors.h"
#include "podm/image_io.h"

extern char** environ;

namespace podm::cli {
namespace {

namespace fs = std::filesystem;

// A new folder, gone with all it holds at the end.
class ScratchFolder {
 public:
  ScratchFolder() : path_(fs::temp_directory_path() / "podm-XXXXXX") {
    HeldLeftovers leftovers;
    if (mkdtemp(path_.data()) == nullptr) throw InputError(fmt::format("cannot make a folder {}", path_));
    leftovers.add(path_);
  }
  ~ScratchFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
    HeldLeftovers().drop(path_);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string operator/(const char* name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::string text_of(const Ranges& ranges) {
  std::vector<std::string> parts;
  for (const auto& [first, last] : ranges)
    parts.push_back(first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last));
  return fmt::format("{}", fmt::join(parts, ","));
}

// The image and what was meshed of it. A phantom is written with its labels selected.
std::vector<std::string> image_options(const MeshRun& run, const ScratchFolder& scratch) {
  const ImageArguments& image = run.command.image;
  const LabelSelection& selection = image.selection;
  const std::string background = fmt::format("{}", selection.background);
  if (image.path.starts_with("phantom:")) {
    write_nifti(run.image, scratch / "image.nii.gz");
    return {"--image", scratch / "image.nii.gz", "--background", background};
  }
  std::vector<std::string> options{"--image", image.path, "--background", background};
  if (!selection.keep.empty()) options.insert(options.end(), {"--labels", text_of(selection.keep)});
  if (!selection.drop.empty()) options.insert(options.end(), {"--drop", text_of(selection.drop)});
  for (const auto& [values, name] : selection.merges)
    options.insert(options.end(), {"--merge", fmt::format("{}={}", fmt::join(values, ","), name)});
  return options;
}

std::vector<std::string> verifier_command(const MeshRun& run, const ScratchFolder& scratch,
                                          const std::string& report) {
  std::vector<std::string> command{
      (fs::read_symlink("/proc/self/exe").parent_path() / "podm-verify").string(), run.command.mesh_path,
      "--json", report, "--claims"};
  std::string claims = "structure,radius_edge,boundary_angles,delaunay,conformity,surface,labels";
  const double radius_mm = run.result.report.radius_mm;
  const auto& radius_of = run.options.radius_of_mm;
  if (radius_mm > 0 || !radius_of.empty()) claims += ",size";
  if (run.command.verify_fidelity) {
    claims += ",fidelity";
    command.insert(command.end() - 1, {"--delta", fmt::format("{}", run.result.report.delta_mm)});
  }
  command.push_back(claims);
  const auto image = image_options(run, scratch);
  command.insert(command.end(), image.begin(), image.end());
  if (radius_mm > 0) command.insert(command.end(), {"--radius", fmt::format("{}", radius_mm)});
  // A foreground label 0 goes by the background's value there.
  const std::uint32_t background = run.command.image.selection.background;
  for (const auto& [label, radius] : radius_of)
    command.insert(command.end(),
                   {"--radius-of", fmt::format("{}={}", label == 0 ? background : label, radius)});
  return command;
}

// As the program was started: standard output goes to standard error, or nowhere; no signal is blocked by
// this one.
pid_t start(const std::vector<std::string>& command, bool quiet, const SignalThread& signals) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &signals.mask_before());
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (quiet) {
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  } else {
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  }
  pid_t child = 0;
  const int error = posix_spawn(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw InputError(fmt::format("--verify: {} cannot be run", command[0]));
  return child;
}

// To its end, or to that which a signal asks for.
void wait_for(pid_t child, const SignalThread& signals) {
  {
    const std::stop_callback end_it(signals.token(), [child] { kill(child, SIGKILL); });
    siginfo_t ended;
    while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
    }
  }  // until then no other process has its number
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace

std::map<std::string, std::string> verify_mesh(const MeshRun& run, const SignalThread& signals) {
  if (signals.token().stop_requested()) return {};
  const ScratchFolder scratch;
  const std::string report_path = scratch / "report.json";
  const auto command = verifier_command(run, scratch, report_path);
  wait_for(start(command, run.command.quiet, signals), signals);
  std::ifstream file(report_path);
  const auto report = nlohmann::ordered_json::parse(file, nullptr, false);
  if (!report.is_object() && signals.token().stop_requested()) return {};
  if (!report.is_object()) throw InputError(fmt::format("--verify: {} gave no report", command[0]));
  std::map<std::string, std::string> verdicts;
  for (const auto& [claim, result] : report.at("claims").items()) verdicts[claim] = result.at("verdict");
  return verdicts;
}

}  // namespace podm::cli
