#include "cli/verify_mesh.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "files/leftovers.h"
#include "files/temporary_file.h"
#include "podm/errors.h"
#include "podm/image_io.h"

extern char** environ;

namespace podm::cli {
namespace {

namespace fs = std::filesystem;

std::string verifier_path() {
  return (fs::read_symlink("/proc/self/exe").parent_path() / "podm-verify").string();
}

[[noreturn]] void fail_to_run(const std::string& program) {
  throw InputError(fmt::format("--verify: {} cannot be run", program));
}

using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::string text_of(const Ranges& ranges) {
  std::vector<std::string> parts;
  for (const auto& [first, last] : ranges)
    parts.push_back(first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last));
  return fmt::format("{}", fmt::join(parts, ","));
}

// The image and what was meshed of it.
std::vector<std::string> image_options(const MeshRun& run, const std::function<std::string()>& write_image) {
  const ImageArguments& image = run.command.image;
  const LabelSelection& selection = image.selection;
  const std::string background = fmt::format("{}", selection.background);
  if (image.is_array || image.is_phantom()) return {"--image", write_image(), "--background", background};
  std::vector<std::string> options{"--image", image.path, "--background", background};
  if (!selection.keep.empty()) options.insert(options.end(), {"--labels", text_of(selection.keep)});
  if (!selection.drop.empty()) options.insert(options.end(), {"--drop", text_of(selection.drop)});
  for (const auto& [values, name] : selection.merges)
    options.insert(options.end(), {"--merge", fmt::format("{}={}", fmt::join(values, ","), name)});
  return options;
}

}  // namespace

std::vector<std::string> claims_to_verify(const MeshRun& run,
                                          const std::function<std::string()>& write_image) {
  std::vector<std::string> options;
  std::string claims = "structure,radius_edge,boundary_angles,conformity,surface,labels";
  // The file tells what it promises of dihedral angles.
  const bool is_delaunay = !run.report.optimization;
  if (is_delaunay) claims += ",delaunay";
  if (run.report.promised_dihedral_deg) claims += ",dihedral";
  const double radius_mm = run.report.radius_mm;
  const auto& radius_of = run.options.sizes.radius_of_mm;
  if (radius_mm > 0 || !radius_of.empty()) claims += ",size";
  if (run.command.verify_fidelity) claims += ",fidelity";
  if (run.command.verify_fidelity || !is_delaunay) {
    options.insert(options.end(), {"--delta", fmt::format("{}", run.report.delta_mm)});
  }
  options.insert(options.end(), {"--claims", claims});
  const auto image = image_options(run, write_image);
  options.insert(options.end(), image.begin(), image.end());
  if (radius_mm > 0) options.insert(options.end(), {"--radius", fmt::format("{}", radius_mm)});
  // A foreground label 0 goes by the background's value there.
  const std::uint32_t background = run.command.image.selection.background;
  for (const auto& [label, radius] : radius_of)
    options.insert(options.end(),
                   {"--radius-of", fmt::format("{}={}", label == 0 ? background : label, radius)});
  return options;
}

namespace {

// A phantom is written to `scratch` with its labels selected.
std::vector<std::string> verifier_command(const MeshRun& run, std::optional<TemporaryFolder>& scratch) {
  std::vector<std::string> command{verifier_path(), run.command.mesh_path, "--json", "-"};
  if (run.command.quiet) command.push_back("--quiet");
  const auto claims = claims_to_verify(run, [&] {
    const std::string path = scratch.emplace(run.command.mesh_path) / "image.nii.gz";
    write_nifti(run.image, path);
    return path;
  });
  command.insert(command.end(), claims.begin(), claims.end());
  return command;
}

// A program whose standard output is read. It is among the leftovers until it is waited for.
class Child {
 public:
  // The child gets the signal mask that this program was started with.
  Child(const std::vector<std::string>& command, const SignalThread& signals) {
    std::array<int, 2> ends;
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw InputError("--verify: no pipe can be made");
    output_ = ends[0];
    const int error = start(command, ends[1], signals);
    ::close(ends[1]);
    if (error == 0) return;
    ::close(output_);
    fail_to_run(command[0]);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Waits for the child, and keeps its number from other processes until it is no longer among the leftovers.
  ~Child() {
    ::close(output_);
    siginfo_t ended;
    while (waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
    }
    HeldLeftovers leftovers;
    waitpid(process_, nullptr, 0);
    leftovers.drop_child(process_);
  }

  // Reads until the child ends, of itself or because a signal asked for it.
  std::string read(const SignalThread& signals) {
    const std::stop_callback end_it(signals.token(), [this] { kill(process_, SIGKILL); });
    std::string text;
    std::array<char, 4096> part;
    for (;;) {
      const ssize_t count = ::read(output_, part.data(), part.size());
      if (count == 0 || (count < 0 && errno != EINTR)) return text;
      if (count > 0) text.append(part.data(), static_cast<std::size_t>(count));
    }
  }

 private:
  int start(const std::vector<std::string>& command, int output, const SignalThread& signals) {
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &signals.mask_before());
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    HeldLeftovers leftovers;
    const int error = posix_spawn(&process_, arguments[0], &actions, &attributes, arguments.data(), environ);
    if (error == 0) leftovers.add_child(process_);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return error;
  }

  pid_t process_ = 0;
  int output_ = -1;
};

}  // namespace

void check_verifier(const std::string& mesh_path) {
  if (mesh_path.ends_with(".xdmf"))
    throw InputError(fmt::format(
        "--verify: podm-verify does not read {}; it reads all other formats that are written", mesh_path));
  if (::access(verifier_path().c_str(), X_OK) != 0) fail_to_run(verifier_path());
}

std::map<std::string, std::string> verify_mesh(const MeshRun& run, const SignalThread& signals) {
  if (signals.token().stop_requested()) return {};
  std::optional<TemporaryFolder> scratch;
  const auto command = verifier_command(run, scratch);
  const auto report = nlohmann::ordered_json::parse(Child(command, signals).read(signals), nullptr, false);
  if (!report.is_object() && signals.token().stop_requested()) return {};
  if (!report.is_object()) throw InputError(fmt::format("--verify: {} gave no report", command[0]));
  std::map<std::string, std::string> verdicts;
  for (const auto& [claim, result] : report.at("claims").items()) verdicts[claim] = result.at("verdict");
  return verdicts;
}

}  // namespace podm::cli
