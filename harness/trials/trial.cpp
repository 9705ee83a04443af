#include "trials/trial.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "machine/load_watch.h"
#include "machine/machine.h"
#include "options/option_matrix.h"
#include "process/stopwatch.h"
#include "process/usable_processors.h"
#include "process/warm_memory.h"
#include "trials/counters.h"
#include "trials/image_info.h"
#include "trials/judgement.h"
#include "trials/ranks.h"
#include "trials/record.h"
#include "trials/side_by_side.h"
#include "trials/solving.h"

namespace podm::bench {
namespace {

constexpr std::size_t kTailBytes = 2000;
constexpr const char *kMeshName = "/mesh.vtu", *kIndexName = "/mesh.pvtu";

std::string mesh_name(const Trial& trial) { return num_ranks(trial) > 0 ? kIndexName : kMeshName; }

std::vector<std::string> mesh_command(const Trial& trial, const Preparation& preparation,
                                      const std::string& podm, const std::string& folder) {
  std::vector<std::string> command = mesher_of(trial, podm);
  command.push_back(preparation.image);
  const auto add = [&command](const std::vector<std::string>& more) {
    command.insert(command.end(), more.begin(), more.end());
  };
  add(mesher_arguments(resolved_options(trial, preparation)));
  if (trial.options.value(kSchedule, false)) add({"--schedule", folder + kScheduleName});
  if (trial.options.value(kReplay, false)) add({"--log", folder + kLogName});
  add({"-o", folder + mesh_name(trial), "--record", folder + kRecordName, "--quiet"});
  return command;
}

// A peer writes any format and names the file in its record.
std::string mesh_path(const Trial& trial, const std::optional<MeshRecord>& record,
                      const std::string& folder) {
  return record && record->mesh ? fmt::format("{}/{}", folder, *record->mesh) : folder + mesh_name(trial);
}

std::uint64_t mesh_bytes(const Trial& trial, const std::string& path) {
  if (num_ranks(trial) > 0) return bytes_of_pieces(path);
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

ProcessRequest request_of(const Trial& trial, const std::vector<std::string>& command,
                          const std::string& folder) {
  return {.arguments = command,
          .stdout_path = {},
          .stderr_path = folder + kMessagesName,
          .timeout_s = trial.timeout_s,
          .memory_limit_bytes = trial.memory_limit_bytes()};
}

// Returns more bytes than any mesher was seen to use for its mesh and files, by the target number of cells,
// but at most kWarmBytes.
std::size_t bytes_to_warm(const Trial& trial) {
  constexpr std::size_t kOfProgram = std::size_t{1} << 27, kOfCell = 400;
  const auto cells = trial.options.value(kTargetElements, kWarmBytes / kOfCell);
  return std::min(kWarmBytes, kOfProgram + kOfCell * cells);
}

// Warms the memory of one copy, and of further copies up to half of the free memory: the memory must be
// touched, but not exhausted. Simulated times do not depend on it.
void warm_memory_of(const Trial& trial) {
  if (basis_of(trial.options, {}) == Basis::kSimulated) return;
  const auto free_bytes = static_cast<std::size_t>(std::max(0L, sysconf(_SC_AVPHYS_PAGES))) *
                          static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const auto copies = static_cast<std::size_t>(std::max(1, num_copies(trial)));
  const std::size_t bytes = bytes_to_warm(trial);
  warm_memory(std::max(bytes, std::min(copies * bytes, free_bytes / 2)));
}

// A mesh that is not proved has status unmet.
void add_fault(const std::string& fault, bool is_interrupted, TrialResult& result) {
  if (fault.empty()) return;
  result.status = is_interrupted ? Status::kInterrupted : Status::kUnmet;
  result.reason += (result.reason.empty() ? "" : "; ") + fault;
}

}  // namespace

struct TrialRunner::Run {
  const Trial& trial;
  const Preparation& preparation;
  const std::string& folder;  ///< the files of the trial
  const StopQuery& stop_requested;
};

const std::optional<ImageSize>& TrialRunner::image_size(const std::string& image) {
  const auto [entry, is_new] = image_sizes_.try_emplace(image);
  if (is_new) entry->second = ask_for_info(programs_.podm, image).size;
  return entry->second;
}

std::string TrialRunner::why_skipped(const Trial& trial) {
  if (trial.if_exists && !image_exists(trial)) return trial.image + " does not exist";
  if (trial.options.value(kImageGrows, false) && !grown(trial.image, 1)) return trial.image + " cannot grow";
  const int copies = num_copies(trial);
  const auto processors = static_cast<int>(usable_processor_ids().size());
  if (copies > processors)
    return fmt::format("{} copies need as many processors; the machine has {}", copies, processors);
  if (const std::string absence = absence_of_ranks(trial, programs_.podm); !absence.empty()) return absence;
  if (is_of_peer(trial) && !peers_.of(trial).absence.empty()) return peers_.of(trial).absence;
  if (!trial.options.value(kSolve, false)) return "";
  if (!absence_of_solver_) absence_of_solver_ = absence_of_solver(programs_.solver);
  return *absence_of_solver_;
}

std::vector<std::string> TrialRunner::command_of(const Run& run, const std::string& folder,
                                                 TrialResult& result) {
  if (!is_of_peer(run.trial)) return mesh_command(run.trial, run.preparation, programs_.podm, folder);
  const Peer& peer = peers_.of(run.trial);
  result.peer = {run.trial.options[kMesher], peer.sha256(), peer.version};
  return peer_command(run.trial, run.preparation, peer, programs_.podm, folder);
}

const CounterTool* TrialRunner::counter_tool_of(const Run& run) {
  const std::string choice = run.trial.options.value(kCounters, kPerfEvent);
  const auto [entry, is_new] = counter_tools_.try_emplace(choice);
  if (is_new) entry->second = counter_tool(choice, programs_.likwid_groups, run.folder);
  return entry->second.get();
}

void TrialRunner::run_program(const Run& run, TrialResult& result) {
  const CounterTool* tool = counter_tool_of(run);
  const std::string absence = tool == nullptr ? "" : tool->absence();
  const bool is_used = tool != nullptr && absence.empty();
  if (is_used) result.command = tool->wrap(result.command, run.folder);
  // likwid-perfctr needs the processor's counters for itself.
  const PerfCounters kernel(is_used ? CounterKinds::kSoftware : CounterKinds::kSoftwareAndHardware);
  const ProcessorUse before = processor_use();
  result.process = run_process(request_of(run.trial, result.command, run.folder), run.stop_requested);
  result.busy_elsewhere = busy_elsewhere(before, processor_use());
  if (!is_used || !tool->is_simulation()) result.counters = kernel.read(result.process);
  if (is_used)
    for (const auto& [name, count] : tool->read(run.folder)) result.counters[name] = count;
  if (!absence.empty())
    result.counters[run.trial.options[kCounters].get<std::string>()] = Unavailable{absence};
}

void TrialRunner::run_copies(const Run& run, TrialResult& result) {
  std::vector<ProcessRequest> requests;
  for (int copy = 0; copy < num_copies(run.trial); ++copy) {
    const std::string folder = folder_of_copy(run.folder, copy);
    std::filesystem::create_directories(folder);
    requests.push_back(request_of(run.trial, command_of(run, folder, result), folder));
  }
  const ProcessorUse before = processor_use();
  run_side_by_side(run.trial, std::move(requests), run.folder, run.stop_requested, result);
  result.busy_elsewhere = busy_elsewhere(before, processor_use());
}

void TrialRunner::measure(const Run& run, TrialResult& result) {
  result.command = {programs_.bench, "latency", "--record", run.folder + kRecordName};
  run_program(run, result);
  judge_measurement(run.folder + kRecordName, result);
}

void TrialRunner::make_mesh(const Run& run, TrialResult& result) {
  const Stopwatch watch;
  result.image_size = image_size(run.preparation.image);
  result.command = command_of(run, run.folder, result);
  warm_memory_of(run.trial);
  result.preparation_s = watch.seconds();
  if (num_copies(run.trial) > 0) {
    run_copies(run, result);
  } else {
    run_program(run, result);
    judge(run.trial, run.folder + kRecordName, result);
  }
  result.mesh_bytes = mesh_bytes(run.trial, mesh_path(run.trial, result.mesh, run.folder));
  if (result.mesh) prove(run, result);
}

void TrialRunner::prove(const Run& run, TrialResult& result) {
  const Stopwatch watch;
  if (!programs_.verifier.empty()) {
    const Verification verification = verify_mesh(run.trial, run.preparation.image, *result.mesh,
                                                  mesh_path(run.trial, result.mesh, run.folder),
                                                  programs_.verifier, run.folder, run.stop_requested);
    result.mesh->verdicts = verification.verdicts;
    result.mesh->dihedral_deg = verification.dihedral_deg;
    result.mesh->topology = verification.topology;
    result.mesh->line_distances = verification.line_distances;
    result.mesh->box_ulps_off = verification.box_ulps_off;
    result.mesh->interface_distance_mm = verification.interface_distance_mm;
    add_fault(verification.fault, verification.is_interrupted, result);
  }
  const auto is_asked_for = [&](const char* key) {
    return run.trial.options.value(key, false) && result.status != Status::kInterrupted;
  };
  if (is_asked_for(kReplay)) replay(run, result);
  if (is_asked_for(kSolve)) solve(run, result);
  result.verification_s = watch.seconds();
}

void TrialRunner::replay(const Run& run, TrialResult& result) {
  const auto [replay, is_interrupted] =
      replay_mesh(run.trial, run.preparation.image, programs_.podm, run.folder, run.stop_requested);
  result.replay = replay;
  const bool is_equal = replay.end == Replay::End::kEqual;
  add_fault(is_equal ? "" : "replay " + replay.text(), is_interrupted, result);
}

void TrialRunner::solve(const Run& run, TrialResult& result) {
  const Solving solving = solve_on_mesh(run.trial, mesh_path(run.trial, result.mesh, run.folder),
                                        programs_.solver, run.stop_requested);
  result.solve = solving.record;
  add_fault(solving.fault, solving.is_interrupted, result);
}

TrialResult TrialRunner::run(const Trial& trial, const Preparation& preparation,
                             const std::string& scratch_folder, const StopQuery& stop_requested) {
  TrialResult result;
  result.preparation = preparation;
  const Run run{trial, preparation, scratch_folder, stop_requested};
  if (makes_mesh(trial))
    make_mesh(run, result);
  else
    measure(run, result);
  if (result.status != Status::kOk)
    result.stderr_tail = read_tail(scratch_folder + kMessagesName, kTailBytes);
  if (result.status == Status::kSkipped)
    result.reason = result.stderr_tail.substr(0, result.stderr_tail.find('\n'));
  return result;
}

}  // namespace podm::bench
