#include "trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "counters.h"
#include "mesher_options.h"
#include "record.h"
#include "warm_memory.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kTailBytes = 2000;
constexpr double kInfoTimeoutS = 120;
constexpr int kExitUnmet = 1;
constexpr double kBytesPerGib = 1024.0 * 1024 * 1024;
constexpr const char* kMeshName = "/mesh.vtu";
constexpr const char* kRecordName = "/record.jsonl";
constexpr const char* kMessagesName = "/stderr.txt";

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<std::string> mesh_command(const Trial& trial, const std::string& podm,
                                      const std::string& folder) {
  std::vector<std::string> command{podm, "mesh", trial.image};
  const std::vector<std::string> options = mesher_arguments(trial.options);
  command.insert(command.end(), options.begin(), options.end());
  if (trial.options.value(kSchedule, false))
    command.insert(command.end(), {"--schedule", folder + kScheduleName});
  command.insert(command.end(), {"-o", folder + kMeshName, "--record", folder + kRecordName, "--quiet"});
  return command;
}

// A peer writes what format it likes and names the file.
std::string mesh_path(const Json& record, const std::string& folder) {
  if (!record.is_object() || !record.contains("mesh")) return folder + kMeshName;
  return fmt::format("{}/{}", folder, text_in(record, "mesh"));
}

// The record names the image by path and hash; how many voxels it has is for memory per cell.
Json read_image_size(const std::string& image_path, const std::string& podm, const std::string& folder) {
  const std::string path = folder + "/info.json";
  const ProcessOutcome info = run_process({.arguments = {podm, "info", image_path, "--json"},
                                           .stdout_path = path,
                                           .stderr_path = {},
                                           .timeout_s = kInfoTimeoutS});
  if (!info.succeeded()) return nullptr;  // meshing tells why
  std::ifstream file(path);
  const Json image = Json::parse(file, nullptr, false);
  return image.is_object() ? image.value("size", Json()) : Json();
}

// Why `record` cannot be used; empty: it can. Asks only for what is read here and in the table.
std::string fault_of(const Json& record) {
  if (!record.is_object()) return "is not a JSON object";
  if (record.value("schema", Json()) != kMesherSchema)
    return fmt::format("is not of schema {}", kMesherSchema);
  const auto at = [&](const char* key) { return record.value(key, Json()); };
  const Json phases = at("phases_s");
  if (!phases.is_object() ||
      !std::all_of(phases.begin(), phases.end(), [](const Json& s) { return s.is_number(); }))
    return "has no seconds by phase";
  for (const char* count : {"cells", "vertices"})
    if (!at(count).is_number_unsigned()) return fmt::format("has no count '{}'", count);
  if (!at("refine_cells_per_second").is_number()) return "has no number 'refine_cells_per_second'";
  if (!at("guarantees").is_object()) return "has no 'guarantees'";
  if (!at("stop_reason").is_string()) return "has no 'stop_reason'";
  return {};
}

// Guarantees by name with the number of their misses, e.g. "radius_edge 3, facet_angle 1".
std::string unmet(const Json& record) {
  std::string text;
  for (const auto& [name, misses] : record["guarantees"].items())
    if (misses != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, misses.dump());
  if (record["stop_reason"] != "complete")
    text += fmt::format("{}stopped: {}", text.empty() ? "" : ", ", record["stop_reason"].get<std::string>());
  return text;
}

void judge_end(TrialResult& result) {
  using End = ProcessOutcome::End;
  result.reason = result.process.describe();
  if (result.process.end == End::kTimedOut) result.status = Status::kTimedOut;
  if (result.process.end == End::kInterrupted) result.status = Status::kInterrupted;
}

void judge_measurement(const std::string& record_path, TrialResult& result) {
  judge_end(result);
  if (!result.process.succeeded()) return;
  std::ifstream file(record_path);
  Json record = Json::parse(file, nullptr, false);
  if (!record.is_object() || !record.value(kMemoryLevels, Json()).is_array()) {
    result.reason += ", without a record";
    return;
  }
  result.record = std::move(record);
  result.status = Status::kOk;
  result.reason.clear();
}

void judge(const Trial& trial, const std::string& record_path, TrialResult& result) {
  judge_end(result);
  const ProcessOutcome& process = result.process;
  if (process.end != ProcessOutcome::End::kExited ||
      (process.exit_code != 0 && process.exit_code != kExitUnmet))
    return;

  std::ifstream file(record_path);
  if (!file) {
    result.reason += ", without a record";
    return;
  }
  Json record = Json::parse(file, nullptr, false);
  if (is_of_peer(trial)) record = complete_record(trial, std::move(record));
  if (const std::string fault = fault_of(record); !fault.empty()) {
    result.reason += ", with a record that " + fault;
    return;
  }
  const std::string misses = unmet(record);
  result.record = std::move(record);
  if (process.exit_code == 0 && misses.empty()) {
    result.status = Status::kOk;
    result.reason.clear();
    return;
  }
  result.status = Status::kUnmet;
  if (!misses.empty()) result.reason = misses;
}

}  // namespace

std::string to_string(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kUnmet:
      return "unmet";
    case Status::kFailed:
      return "failed";
    case Status::kTimedOut:
      return "timed_out";
    case Status::kInterrupted:
      return "interrupted";
    case Status::kSkipped:
      break;
  }
  return "skipped";
}

const Json& TrialRunner::image_size(const std::string& image, const std::string& scratch_folder) {
  const auto [entry, is_new] = image_sizes_.try_emplace(image);
  if (is_new) entry->second = read_image_size(image, programs_.podm, scratch_folder);
  return entry->second;
}

void TrialRunner::verify(const Trial& trial, const std::string& scratch_folder,
                         const StopQuery& stop_requested, TrialResult& result) {
  const Stopwatch watch;
  const Verification verification =
      verify_mesh(trial, result.image_size, result.record, mesh_path(result.record, scratch_folder),
                  programs_, scratch_folder, stop_requested);
  result.verification_s = watch.seconds();
  result.record["verdicts"] = verification.verdicts;
  if (verification.fault.empty()) return;
  result.status = verification.is_interrupted ? Status::kInterrupted : Status::kUnmet;
  result.reason += (result.reason.empty() ? "" : "; ") + verification.fault;
}

bool TrialRunner::skip(const Trial& trial, TrialResult& result) {
  if (trial.if_exists && !image_exists(trial)) result.reason = trial.image + " is not there";
  if (is_of_peer(trial) && result.reason.empty()) result.reason = peers_.of(trial).absence;
  if (!result.reason.empty()) result.status = Status::kSkipped;
  return !result.reason.empty();
}

void TrialRunner::set_command(const Trial& trial, const std::string& scratch_folder, TrialResult& result) {
  if (!is_of_peer(trial)) {
    result.command = mesh_command(trial, programs_.podm, scratch_folder);
    return;
  }
  const Peer& peer = peers_.of(trial);
  const std::string image = image_file(trial, result.image_size, programs_.podm, scratch_folder);
  result.command = peer_command(trial, peer, image, programs_.podm, scratch_folder);
  result.peer = {{"name", trial.options[kMesher]}, {"sha256", peer.sha256()}, {"version", peer.version}};
}

const CounterTool* TrialRunner::counter_tool_of(const Trial& trial, const std::string& scratch_folder) {
  const std::string choice = trial.options.value(kCounters, kPerfEvent);
  const auto [entry, is_new] = counter_tools_.try_emplace(choice);
  if (is_new) entry->second = counter_tool(choice, programs_.likwid_groups, scratch_folder);
  return entry->second.get();
}

void TrialRunner::run_program(const Trial& trial, const std::string& scratch_folder,
                              const StopQuery& stop_requested, TrialResult& result) {
  const CounterTool* tool = counter_tool_of(trial, scratch_folder);
  const std::string absence = tool == nullptr ? "" : tool->absence();
  const bool is_used = tool != nullptr && absence.empty();
  if (is_used) result.command = tool->wrap(result.command, scratch_folder);
  // likwid-perfctr needs the processor's counters for itself.
  const PerfCounters kernel(is_used ? CounterKinds::kSoftware : CounterKinds::kSoftwareAndHardware);
  result.process =
      run_process({.arguments = result.command,
                   .stdout_path = {},
                   .stderr_path = scratch_folder + kMessagesName,
                   .timeout_s = trial.timeout_s,
                   .memory_limit_bytes = static_cast<std::uint64_t>(trial.memory_limit_gib * kBytesPerGib)},
                  stop_requested);
  if (!is_used || !tool->is_simulation()) result.counters = kernel.read(result.process);
  if (is_used) result.counters.update(tool->read(scratch_folder));
  if (!absence.empty())
    result.counters[trial.options[kCounters].get<std::string>()] = "unavailable: " + absence;
}

void TrialRunner::measure(const Trial& trial, const std::string& scratch_folder,
                          const StopQuery& stop_requested, TrialResult& result) {
  result.command = {programs_.bench, "latency", "--record", scratch_folder + kRecordName};
  run_program(trial, scratch_folder, stop_requested, result);
  judge_measurement(scratch_folder + kRecordName, result);
}

void TrialRunner::make_mesh(const Trial& trial, const std::string& scratch_folder,
                            const StopQuery& stop_requested, TrialResult& result) {
  const Stopwatch watch;
  result.image_size = image_size(trial.image, scratch_folder);
  set_command(trial, scratch_folder, result);
  warm_memory(kWarmBytes);
  result.preparation_s = watch.seconds();
  run_program(trial, scratch_folder, stop_requested, result);
  judge(trial, scratch_folder + kRecordName, result);
  std::error_code error;
  const auto mesh_bytes = std::filesystem::file_size(mesh_path(result.record, scratch_folder), error);
  if (!error) result.mesh_bytes = mesh_bytes;
  if (result.record.is_object() && !programs_.verifier.empty())
    verify(trial, scratch_folder, stop_requested, result);
}

TrialResult TrialRunner::run(const Trial& trial, const std::string& scratch_folder,
                             const StopQuery& stop_requested) {
  TrialResult result;
  if (skip(trial, result)) return result;
  if (makes_mesh(trial))
    make_mesh(trial, scratch_folder, stop_requested, result);
  else
    measure(trial, scratch_folder, stop_requested, result);
  if (result.status != Status::kOk)
    result.stderr_tail = read_tail(scratch_folder + kMessagesName, kTailBytes);
  return result;
}

}  // namespace podm::bench
