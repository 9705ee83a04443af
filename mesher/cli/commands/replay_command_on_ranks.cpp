// podm-mpi replay: each rank replays its own log of a run on ranks.
#include <fmt/format.h>

#include <cstdio>
#include <optional>

#include "cli/commands/labelled_image.h"
#include "cli/commands/mesh_on_ranks.h"
#include "cli/options/option_values.h"
#include "distributed/collective_errors.h"
#include "distributed/in_process_ranks.h"
#include "distributed/replay_on_ranks.h"
#include "podm/mesh_io.h"

namespace podm::cli {
namespace {

OperationLog read_own_log(const ReplayCommand& command, const LabelImage& image, int rank) {
  const std::string path = fmt::format("{}.{}", command.log_paths.front(), rank);
  OperationLog log = read_operation_log(path);
  if (log.head.image_sha256 != label_image_sha256(image))
    throw InputError(fmt::format("{}: logged for another image than {} with these label options", path,
                                 command.image.path));
  return log;
}

void report(const std::string& name, const ReplayOnRanks& replayed, const std::string& hash_of_log) {
  const std::string hash = mesh_hash_text(replayed.mesh_hash);
  fmt::print(stderr, "{}: {} operations, {} cells\nhash of the log    {}\nhash of the replay {}\n", name,
             replayed.operations, replayed.cells, hash_of_log, hash);
  fmt::print(
      stderr, "{}\n",
      hash == hash_of_log ? "the run equals its replay" : "podm-mpi: the run does not equal its replay");
}

}  // namespace

int replay_on_ranks(const ReplayCommand& command, Communication& ranks, SharedByRanks& shared) {
  if (ranks.size() == 1)
    throw RefusedByAll("one rank cannot replay the logs of several; podm replay replays the log of one");
  std::shared_ptr<const LabelImage> image;
  OperationLog log;
  Space space{};
  const auto read = [&] {
    const auto make = [&] {
      return std::make_shared<const LabelImage>(read_labelled_image(command.image, 1));
    };
    image = shared.image.get(make, ranks);
    log = read_own_log(command, *image, ranks.rank());
    space = parse_choice<Space>(log.head.space, command.log_paths.front());
  };
  do_collectively(read, ranks);
  const ReplayOnRanks replayed =
      podm::replay_on_ranks(*image, log, space, 1, ranks, shared.meshing.isosurface);
  if (ranks.rank() == 0)
    report(fmt::format("{}.0 and {} more", command.log_paths.front(), ranks.size() - 1), replayed,
           log.head.mesh_hash);
  return mesh_hash_text(replayed.mesh_hash) == log.head.mesh_hash ? 0 : 1;
}

int replay_in_process(const ReplayCommand& command) {
  return run_in_process(
      {.num_ranks = command.ranks_in_process, .one_at_a_time = true},
      [&](Communication& ranks, SharedByRanks& shared) { return replay_on_ranks(command, ranks, shared); });
}

}  // namespace podm::cli
