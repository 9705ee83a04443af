#include "cli/mesh_on_ranks.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <optional>

#include "algorithms/team_size.h"
#include "cli/appended_file.h"
#include "cli/input_sha256.h"
#include "cli/labelled_image.h"
#include "cli/mesh_run.h"
#include "cli/options_for_image.h"
#include "cli/process_memory.h"
#include "cli/progress_display.h"
#include "cli/ranks_of_machine.h"
#include "cli/told_by_ranks.h"
#include "cli/verify_mesh.h"
#include "distributed/mesh_image_on_ranks.h"
#include "distributed/together.h"
#include "distributed/write_pieces.h"
#include "podm/mesh_io.h"
#include "podm/operation_log.h"

namespace podm::cli {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void refuse(const std::string& path, const char* option) {
  if (!path.empty())
    throw InputError(fmt::format("{} cannot be had on ranks yet; podm mesh has it, on one machine", option));
}

void check_command(const MeshCommand& command) {
  refuse(command.surface_path, "--surface");
  refuse(command.schedule_path, "--schedule");
  check_options_on_ranks(command.meshing);
  check_pieces_path(command.mesh_path);
  if (command.verify) check_verifier(command.mesh_path);
}

class Run {
 public:
  Run(MeshCommand command, Communication& ranks, SignalThread& signals)
      : command_(std::move(command)),
        ranks_(ranks),
        signals_(signals),
        machines_(ranks),
        run_{.command = command_,
             .image = image_,
             .options = {},
             .crossover = {},
             .report = {},
             .mesh = {},
             .mesh_sha256 = {},
             .verdicts = {},
             .program = "podm-mpi"} {}

  int operator()() {
    prepare();
    MeshingOnRanks result = mesh();
    const auto start = std::chrono::steady_clock::now();
    if (result.piece.total_cells > 0) write_pieces(result.piece, command_.mesh_path, ranks_);
    run_.report = std::move(result.report);
    if (log_) write_log(result.mesh_hash);
    run_.write_s = seconds_since(start);
    auto& warnings = run_.report.warnings;
    warnings = machines_.warnings(command_.meshing.team.threads);
    warnings.insert(warnings.end(), image_.warnings.begin(), image_.warnings.end());
    gather_from_ranks(result, command_.meshing.team.threads, peak_resident_bytes(), machines_, ranks_, run_);
    std::array<std::uint64_t, 1> code{0};
    if (ranks_.rank() == 0) {
      if (command_.verify && run_.mesh.cells > 0) run_.verdicts = verify_mesh(run_, signals_);
      code[0] = static_cast<std::uint64_t>(tell(run_, records_));
    }
    ranks_.maximum(code);
    return static_cast<int>(code[0]);
  }

 private:
  // All that may be refused before there is work to lose.
  void prepare() {
    TeamOptions& team = command_.meshing.team;
    if (team.threads == 0 && team.nodes == 0 && team.cores_per_node == 0)
      team.threads = machines_.share_of_processors();
    team.threads = num_workers(team);
    const auto check = [&] {
      check_command(command_);
      if (ranks_.rank() == 0 && !command_.record_path.empty()) records_.emplace(command_.record_path);
      if (!command_.log_path.empty()) log_.emplace(own_log_path());
    };
    do_together(check, ranks_);
    expect_agreement({{"program", "SHA-256 " + file_sha256("/proc/self/exe")},
                      {"output", command_.mesh_path},
                      {"--log", command_.log_path},
                      {"--verify", command_.verify ? "asked for" : "not asked for"}},
                     ranks_);
    std::uint64_t limit_bytes = memory_limit_bytes(command_);
    if (command_.max_memory_bytes == 0) limit_bytes /= static_cast<std::uint64_t>(machines_.num_ranks_here());
    const auto start = std::chrono::steady_clock::now();
    const auto read = [&] {
      image_ = read_labelled_image(command_.image, team.threads, bytes_for_image(limit_bytes));
      run_.read_s = seconds_since(start);
      run_.options = options_for_image(command_, image_, limit_bytes, ranks_.size());
      if (log_) run_.options.log = &*log_;
    };
    do_together(read, ranks_);
  }

  std::string own_log_path() const {
    return ranks_.size() == 1 ? command_.log_path : fmt::format("{}.{}", command_.log_path, ranks_.rank());
  }

  // No rank's log gets its name before all are on the disks.
  void write_log(std::uint64_t mesh_hash) {
    const OperationLogHead head{.box = run_.report.virtual_box,
                                .image_sha256 = label_image_sha256(image_),
                                .space = to_string(run_.options.space),
                                .mesh_sha256 = {},
                                .mesh_hash = mesh_hash_text(mesh_hash),
                                .rank = ranks_.rank(),
                                .num_ranks = ranks_.size()};
    do_together([&] { log_->finish(head); }, ranks_);
    do_together([&] { log_->publish(); }, ranks_);
  }

  MeshingOnRanks mesh() {
    using Style = ProgressDisplay::Style;
    const bool is_silent = command_.quiet || ranks_.rank() != 0;
    ProgressDisplay display(stderr, is_silent ? Style::kNone : ProgressDisplay::style_for(stderr));
    const auto progress = [&](const Progress& now) {
      if (now.phase != "transform") signals_.heed_first(is_silent);
      display.show(now);
    };
    return mesh_image_on_ranks(image_, run_.options, ranks_, progress, signals_.token());
  }

  MeshCommand command_;
  Communication& ranks_;
  SignalThread& signals_;
  const RanksOfMachine machines_;
  LabelImage image_;
  MeshRun run_;
  std::optional<AppendedFile> records_;  // rank 0's
  std::optional<OperationLogWriter> log_;
};

}  // namespace

int mesh_on_ranks(MeshCommand command, Communication& ranks, SignalThread& signals) {
  return Run(std::move(command), ranks, signals)();
}

}  // namespace podm::cli
