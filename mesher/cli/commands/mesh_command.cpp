// podm mesh: checks the outputs, reads the image, estimates the cost, makes and writes the mesh, and reports.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <future>
#include <optional>

#include "algorithms/team_size.h"
#include "cli/commands/commands.h"
#include "cli/commands/labelled_image.h"
#include "cli/commands/mesh_run.h"
#include "cli/commands/verify_mesh.h"
#include "cli/options/options_for_image.h"
#include "cli/processes/process_memory.h"
#include "cli/processes/signal_thread.h"
#include "cli/reports/appended_file.h"
#include "cli/reports/leaf_schedule_file.h"
#include "cli/reports/mesh_page.h"
#include "cli/reports/progress_display.h"
#include "files/atomic_file.h"
#include "podm/mesh_io.h"
#include "podm/operation_log.h"

namespace podm::cli {
namespace {

// Returns the duration of `action` in seconds.
template <class Action>
double timed(const Action& action) {
  const auto start = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Checks the outputs before the run, because a misspelt folder must not waste hours of meshing.
void check_outputs(const MeshCommand& command, const SignalThread& signals) {
  check_mesh_path(command.mesh_path, command.mesh_file);
  if (!command.surface_path.empty()) check_surface_path(command.surface_path);
  const Algorithm algorithm = command.meshing.algorithm;
  if (!command.schedule_path.empty()) {
    if (algorithm != Algorithm::kPdr && algorithm != Algorithm::kPdrPodm)
      throw InputError(fmt::format("{}: {} has no leaves; use --algorithm pdr or pdr-podm",
                                   command.schedule_path, to_string(algorithm)));
    const AtomicFile trial(command.schedule_path);
  }
  if (command.verify) check_verifier(command);
  if (!command.page_path.empty()) check_page(command, signals);
}

// From the start of refinement on there is a mesh to keep, so the first signal only requests a stop.
MeshingResult mesh_with_display(const LabelImage& image, const MeshingOptions& options,
                                const MeshCommand& command, SignalThread& signals) {
  using Style = ProgressDisplay::Style;
  ProgressDisplay display = command.json_progress ? ProgressDisplay(stdout, Style::kJson)
                            : command.quiet       ? ProgressDisplay(stderr, Style::kNone)
                                            : ProgressDisplay(stderr, ProgressDisplay::style_for(stderr));
  const auto progress = [&](const Progress& now) {
    if (now.phase != "transform") signals.stop_on_first_signal(command.quiet);
    display.show(now);
  };
  return mesh_image(image, options, progress, signals.token());
}

// The mesh must be canonical and hashed.
void finish_log(OperationLogWriter& log, const MeshRun& run) {
  log.finish({.box = run.report.virtual_box,
              .image_sha256 = label_image_sha256(run.image),
              .space = to_string(run.options.space),
              .mesh_sha256 = run.mesh_sha256,
              .smoothing_mm = run.options.smoothing_mm,
              .is_box_flat = run.image.is_box_flat});
  log.publish();
}

void write_outputs(const MeshCommand& command, const TetMesh& mesh, std::vector<std::string>& warnings) {
  if (mesh.cells.empty()) return;  // MeshRun::unmet() reports it
  for (const std::string& loss : write_mesh(mesh, command.mesh_path, command.mesh_file))
    warnings.push_back(command.mesh_path + ": " + loss);
  if (!command.surface_path.empty()) write_surfaces(mesh, command.surface_path);
}

}  // namespace

int run(const MeshCommand& command) {
  SignalThread signals;
  check_outputs(command, signals);
  std::optional<AppendedFile> records;
  if (!command.record_path.empty()) records.emplace(command.record_path);
  const std::uint64_t limit_bytes = memory_limit_bytes(command);
  LabelImage image;
  const double read_s = timed([&] {
    image =
        read_labelled_image(command.image, loop_threads(command.meshing.team), bytes_for_image(limit_bytes));
    image.is_box_flat = command.meshing.box == BoxFaces::kFlat;
  });
  MeshRun run{.command = command,
              .image = image,
              .options = options_for_image(command, image, limit_bytes),
              .report = {},
              .mesh = {},
              .mesh_sha256 = {},
              .read_s = read_s,
              .verification = nullptr};
  const ImagesOfValues images_of_values(command, image, bytes_for_image(limit_bytes));
  std::optional<OperationLogWriter> log;
  if (!command.log_path.empty()) run.options.log = &log.emplace(command.log_path);
  run.options.leaves.with_schedule = !command.schedule_path.empty();
  MeshingResult result = mesh_with_display(image, run.options, command, signals);
  run.take(std::move(result.report), result.mesh);
  const int threads = loop_threads(command.meshing.team);
  const double canonicalize_s = timed([&] { canonicalize(result.mesh, threads); });
  run.values_s = timed([&] { run.values = images_of_values.add_to(result.mesh); });
  run.write_s = canonicalize_s + timed([&] {
                  // Computes the hash during writing if there are threads for both.
                  std::future<std::string> hash =
                      std::async(threads == 1 ? std::launch::deferred : std::launch::async,
                                 [&] { return mesh_sha256(result.mesh); });
                  write_outputs(command, result.mesh, run.report.warnings);
                  run.mesh_sha256 = hash.get();
                  if (log) finish_log(*log, run);
                  if (!command.schedule_path.empty()) write_schedule(run, command.schedule_path);
                });
  run.peak_rss_bytes = peak_resident_bytes();
  if (command.verify && run.mesh.cells > 0) run.verification = verify_mesh(run, signals);
  const int exit_code = report(run, records);
  if (!command.page_path.empty() && run.mesh.cells > 0) write_page(run, result.mesh, signals);
  return exit_code;
}

}  // namespace podm::cli
