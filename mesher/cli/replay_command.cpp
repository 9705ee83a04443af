// podm replay: a run's operations carried out in their order on one thread, and the mesh compared.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "cli/commands.h"
#include "cli/labelled_image.h"
#include "cli/option_values.h"
#include "podm/mesh_io.h"
#include "podm/operation_log.h"

namespace podm::cli {
namespace {

TetMesh replay_log(const std::string& path, const LabelImage& image, const OperationLog& log,
                   Space space) try {
  return replay_operations(image, log, space);
} catch (const InputError& error) {
  throw InputError(path + ": " + error.what());
}

}  // namespace

int run(const ReplayCommand& command) {
  const LabelImage image = read_labelled_image(command.image);
  const OperationLog log = read_operation_log(command.log_path);
  if (log.head.image_sha256 != label_image_sha256(image))
    throw InputError(fmt::format("{}: made from another image than {} with these label options",
                                 command.log_path, command.image.path));
  const Space space = parse_choice<Space>(log.head.space, command.log_path);
  TetMesh mesh = replay_log(command.log_path, image, log, space);
  canonicalize(mesh);
  const std::string sha256 = mesh_sha256(mesh);
  const auto num_operations =
      std::count_if(log.all.operations.begin(), log.all.operations.end(),
                    [](const LoggedOperation& logged) { return logged.kind != kMovedVertex; });
  fmt::print(stderr, "{}: {} operations, {} cells\nsha256 of the log    {}\nsha256 of the replay {}\n",
             command.log_path, num_operations, mesh.cells.size(), log.head.mesh_sha256, sha256);
  const bool is_same = sha256 == log.head.mesh_sha256;
  fmt::print(stderr, "{}\n",
             is_same ? "the run equals its replay" : "podm: the run does not equal its replay");
  return is_same ? 0 : 1;
}

}  // namespace podm::cli
