// podm replay: replays a run's operations in their order on one thread, and compares the mesh.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "cli/commands/commands.h"
#include "cli/commands/labelled_image.h"
#include "cli/options/option_values.h"
#include "podm/mesh_io.h"
#include "replay/merge_logs.h"

namespace podm::cli {
namespace {

LogOfRank read_log(const std::string& path, const ReplayCommand& command, const std::string& image_sha256) {
  LogOfRank read{path, read_operation_log(path)};
  if (read.log.head.image_sha256 != image_sha256)
    throw InputError(fmt::format("{}: logged for another image than {} with these label options", path,
                                 command.image.path));
  return read;
}

OperationLog read_logs(const ReplayCommand& command, const std::string& image_sha256) {
  std::vector<LogOfRank> logs;
  for (const std::string& path : command.log_paths) logs.push_back(read_log(path, command, image_sha256));
  return merge_logs(std::move(logs));
}

TetMesh replay_log(const std::string& name, const LabelImage& image, const OperationLog& log) try {
  return replay_operations(image, log, parse_choice<Space>(log.head.space, name));
} catch (const InputError& error) {
  throw InputError(name + ": " + error.what());
}

// The mesh hashes of the run and of the replay.
struct Hashes {
  const char* kind;
  std::string of_log, of_replay;
};

Hashes hashes_of(const OperationLogHead& head, TetMesh& mesh) {
  if (!head.mesh_hash.empty()) return {"hash", head.mesh_hash, mesh_hash_text(mesh_hash(mesh))};
  canonicalize(mesh);
  return {"sha256", head.mesh_sha256, mesh_sha256(mesh)};
}

}  // namespace

int run(const ReplayCommand& command) {
  LabelImage image = read_labelled_image(command.image);
  const OperationLog log = read_logs(command, label_image_sha256(image));
  image.is_box_flat = log.head.is_box_flat;
  const std::string& first = command.log_paths.front();
  const std::string name =
      log.head.num_ranks == 1 ? first : fmt::format("{} and {} more", first, log.head.num_ranks - 1);
  TetMesh mesh = replay_log(name, image, log);
  const Hashes hashes = hashes_of(log.head, mesh);
  const auto num_operations =
      std::count_if(log.all.operations.begin(), log.all.operations.end(),
                    [](const LoggedOperation& logged) { return logged.kind != kMovedVertex; });
  fmt::print(stderr, "{}: {} operations, {} cells\n{:<6} of the log    {}\n{:<6} of the replay {}\n", name,
             num_operations, mesh.cells.size(), hashes.kind, hashes.of_log, hashes.kind, hashes.of_replay);
  const bool is_same = hashes.of_log == hashes.of_replay;
  fmt::print(stderr, "{}\n",
             is_same ? "the run equals its replay" : "podm: the run does not equal its replay");
  return is_same ? 0 : 1;
}

}  // namespace podm::cli
