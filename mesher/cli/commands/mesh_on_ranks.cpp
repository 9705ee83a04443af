#include "cli/commands/mesh_on_ranks.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <optional>

#include "algorithms/team_size.h"
#include "cli/commands/labelled_image.h"
#include "cli/commands/mesh_run.h"
#include "cli/commands/verify_mesh.h"
#include "cli/options/options_for_image.h"
#include "cli/processes/own_program.h"
#include "cli/processes/ranks_of_machine.h"
#include "cli/reports/appended_file.h"
#include "cli/reports/input_sha256.h"
#include "cli/reports/progress_display.h"
#include "cli/reports/ranks_record.h"
#include "distributed/collective_errors.h"
#include "distributed/in_process_ranks.h"
#include "distributed/read_by_bricks.h"
#include "distributed/write_pieces.h"
#include "files/temporary_name.h"
#include "podm/mesh_io.h"
#include "podm/operation_log.h"

namespace podm::cli {
namespace {

void check_command(const MeshCommand& command) {
  check_options_on_ranks(command.meshing);
  check_pieces_path(command.mesh_path);
  if (!command.surface_path.empty()) check_surface_path(command.surface_path);
  if (command.verify) check_verifier(command);
}

class Run {
 public:
  Run(MeshCommand command, Communication& ranks, SignalThread& signals, SharedByRanks& shared)
      : command_(std::move(command)), ranks_(ranks), signals_(signals), shared_(shared), machines_(ranks) {}

  int operator()() {
    check();
    MeshRun run = prepare();
    MeshingOnRanks result = mesh(run);
    const double start_s = ranks_.seconds();
    if (result.piece.total_cells > 0) {
      write_pieces(result.piece, command_.mesh_path, ranks_);
      if (!command_.surface_path.empty()) write_surfaces(result.piece, command_.surface_path, ranks_);
    }
    run.report = std::move(result.report);
    if (log_) write_log(run, result);
    run.write_s = ranks_.seconds() - start_s;
    auto& warnings = run.report.warnings;
    const auto add = [&](const std::vector<std::string>& more) {
      warnings.insert(warnings.end(), more.begin(), more.end());
    };
    if (!is_in_process()) add(machines_.warnings(command_.meshing.team.threads));
    add(run.image.warnings);
    gather_from_ranks(result, command_.meshing.team.threads, machines_, ranks_, run);
    std::array<std::uint64_t, 1> code{0};
    if (ranks_.rank() == 0) {
      if (command_.verify && run.mesh.cells > 0) run.verification = verify_mesh(run, signals_);
      code[0] = static_cast<std::uint64_t>(report(run, records_));
    }
    ranks_.maximum(code);
    return static_cast<int>(code[0]);
  }

 private:
  bool is_in_process() const { return command_.ranks_in_process > 0; }

  // Refuses everything that can be refused before the run has work to lose.
  void check() {
    TeamOptions& team = command_.meshing.team;
    if (team.threads == 0 && team.nodes == 0 && team.cores_per_node == 0)
      team.threads = is_in_process() ? 1 : machines_.share_of_processors();
    team.threads = num_workers(team);
    const auto check = [&] {
      check_command(command_);
      if (ranks_.rank() == 0 && !command_.record_path.empty()) records_.emplace(command_.record_path);
      if (!command_.log_path.empty()) log_.emplace(own_log_path());
    };
    do_collectively(check, ranks_);
    expect_agreement({{"program", "SHA-256 " + file_sha256(kOwnProgram)},
                      {"output", command_.mesh_path},
                      {"--log", command_.log_path},
                      {"--surface", command_.surface_path},
                      {"--checkpoint", command_.checkpoints.folder},
                      {"--checkpoint-seconds", fmt::format("{}", command_.checkpoints.least_seconds)},
                      {"--resume", command_.checkpoints.resume ? "requested" : "not requested"},
                      {"--verify", command_.verify ? "requested" : "not requested"}},
                     ranks_);
  }

  // Each process holds the image once, and its ranks share the rest of the memory.
  MeshRun prepare() {
    const std::uint64_t ranks_here = is_in_process() ? static_cast<std::uint64_t>(ranks_.size()) : 1;
    std::uint64_t limit_bytes = memory_limit_bytes(command_);
    if (command_.max_memory.bytes == 0 && !is_in_process())
      limit_bytes /= static_cast<std::uint64_t>(machines_.num_ranks_here());
    const double start_s = ranks_.seconds();
    read_image(limit_bytes);
    MeshingOptions options;
    const auto complete = [&] {
      options = options_for_image(command_, *image_, limit_bytes, is_in_process() ? 1 : ranks_.size());
      options.limits.max_memory_bytes /= ranks_here;
      if (log_) options.log = &*log_;
    };
    do_collectively(complete, ranks_);
    return {.command = command_,
            .image = *image_,
            .options = std::move(options),
            .report = {},
            .mesh = {},
            .mesh_sha256 = {},
            .read_s = ranks_.seconds() - start_s,
            .verification = nullptr,
            .program = "podm-mpi"};
  }

  void read_image(std::uint64_t limit_bytes) {
    const int threads = command_.meshing.team.threads;
    std::shared_ptr<const VoxelFile> file;
    LabelSelection selection;
    const auto open = [&] {
      if (!stays_in_file()) return;
      file = VoxelFile::open(command_.image.path);
      if (file && file->is_compressed() && file->grid().num_voxels() <= kMaxVoxels) file = nullptr;
      selection = with_table(command_.image);
    };
    do_collectively(open, ranks_);
    std::array<std::uint64_t, 1> num_whole{file == nullptr ? 1u : 0u};
    ranks_.sum(num_whole);
    if (num_whole[0] == 0) {
      image_ = read_by_bricks(file, selection, threads, bytes_for_image(limit_bytes), shared_.image, ranks_);
      return;
    }
    const auto make = [&] {
      return std::make_shared<const LabelImage>(
          read_labelled_image(command_.image, threads, bytes_for_image(limit_bytes)));
    };
    do_collectively([&] { image_ = shared_.image.get(make, ranks_); }, ranks_);
  }

  // A single rank has the image as a whole, and so has a rank with an option that needs all voxels.
  bool stays_in_file() const {
    return ranks_.size() > 1 && !command_.image.is_phantom() && command_.log_path.empty() &&
           command_.size_near.empty() && command_.size_image_path.empty() &&
           can_stay_in_file(command_.image.selection, command_.meshing);
  }

  std::string own_log_path() const {
    return ranks_.size() == 1 ? command_.log_path : fmt::format("{}.{}", command_.log_path, ranks_.rank());
  }

  // No rank's log gets its name before all logs are on the disks.
  void write_log(const MeshRun& run, MeshingOnRanks& result) {
    std::optional<CubesOfRank> cubes;
    if (ranks_.size() > 1) cubes = std::move(result.cubes);
    const OperationLogHead head{.box = run.report.virtual_box,
                                .image_sha256 = label_image_sha256(run.image),
                                .space = to_string(run.options.space),
                                .mesh_sha256 = {},
                                .mesh_hash = mesh_hash_text(result.mesh_hash),
                                .rank = ranks_.rank(),
                                .num_ranks = ranks_.size(),
                                .smoothing_mm = run.options.smoothing_mm,
                                .cubes = std::move(cubes)};
    do_collectively([&] { log_->finish(head); }, ranks_);
    do_collectively([&] { log_->publish(); }, ranks_);
    if (ranks_.rank() == 0) remove_logs_of_more_ranks();
  }

  // Removes the logs of an earlier run on more ranks, which would look like logs of this run, and what a
  // killed one has left of its logs.
  void remove_logs_of_more_ranks() const {
    remove_old_temporaries(folder_of(command_.log_path), [&](const std::string& target) {
      const std::string prefix = command_.log_path + ".";
      return target.starts_with(prefix) && target.size() > prefix.size() &&
             target.find_first_not_of("0123456789", prefix.size()) == std::string::npos;
    });
    std::error_code error;
    for (int rank = ranks_.size() == 1 ? 0 : ranks_.size();; ++rank)
      if (!std::filesystem::remove(fmt::format("{}.{}", command_.log_path, rank), error)) return;
  }

  // A process has one progress bar and one signal thread. Rank 0 serves both in a process with several ranks.
  MeshingOnRanks mesh(const MeshRun& run) {
    using Style = ProgressDisplay::Style;
    const bool is_silent = command_.quiet || ranks_.rank() != 0;
    ProgressDisplay display =
        command_.json_progress && ranks_.rank() == 0
            ? ProgressDisplay(stdout, Style::kJson)
            : ProgressDisplay(stderr, is_silent ? Style::kNone : ProgressDisplay::style_for(stderr));
    const auto progress = [&](const Progress& now) {
      if (is_in_process() && ranks_.rank() != 0) return;
      if (now.phase != "transform") signals_.stop_on_first_signal(is_silent);
      display.show(now);
    };
    const CheckpointArguments& checkpoints = command_.checkpoints;
    return mesh_image_on_ranks(run.image, run.options, ranks_, progress, signals_.token(), &shared_.meshing,
                               {.folder = checkpoints.folder,
                                .seconds = checkpoints.least_seconds,
                                .is_resumed = checkpoints.resume});
  }

  MeshCommand command_;
  Communication& ranks_;
  SignalThread& signals_;
  SharedByRanks& shared_;
  const RanksOfMachine machines_;
  std::shared_ptr<const LabelImage> image_;
  std::optional<AppendedFile> records_;  // only on rank 0
  std::optional<OperationLogWriter> log_;
};

}  // namespace

int mesh_on_ranks(MeshCommand command, Communication& ranks, SignalThread& signals, SharedByRanks& shared) {
  return Run(std::move(command), ranks, signals, shared)();
}

int run_in_process(const InProcessOptions& options,
                   const std::function<int(Communication&, SharedByRanks&)>& command) {
  SharedByRanks shared;
  std::optional<RefusedByAll> refusal;
  int code = 0;
  run_ranks(options, [&](Communication& ranks) {
    try {
      const int own_code = command(ranks, shared);
      if (ranks.rank() == 0) code = own_code;
    } catch (const RefusedByAll& error) {  // all ranks end in the regular way
      if (ranks.rank() == 0) refusal = error;
    }
  });
  if (refusal) throw RefusedByAll(*refusal);
  return code;
}

int mesh_in_process(const MeshCommand& command, SignalThread& signals) {
  constexpr double kSecondsPerUs = 1e-6, kBytesPerGigabyte = 1e9;
  const InProcessOptions options{.num_ranks = command.ranks_in_process,
                                 .one_at_a_time = true,
                                 .has_virtual_threads = command.meshing.team.executor == Executor::kVirtual,
                                 .seed = command.meshing.team.seed,
                                 .latency_s = kSecondsPerUs * command.network.latency_us,
                                 .bytes_per_s = kBytesPerGigabyte * command.network.gigabytes_per_s};
  return run_in_process(options, [&](Communication& ranks, SharedByRanks& shared) {
    return mesh_on_ranks(command, ranks, signals, shared);
  });
}

}  // namespace podm::cli
