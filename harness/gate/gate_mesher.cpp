#include "gate/gate_mesher.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "errors.h"
#include "process/warm_memory.h"
#include "rows/codec.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kTimeoutS = 600;
constexpr std::size_t kWarmBytesOfGate = std::size_t{1} << 28;  // more than a trial of the gate uses

}  // namespace

GateMesher::GateMesher(StopQuery stop_requested)
    : folder_(fs::temp_directory_path() / "podm-gate-XXXXXX"), stop_requested_(std::move(stop_requested)) {
  if (mkdtemp(folder_.data()) == nullptr)
    throw InputError(fmt::format("cannot make a folder {}: {}", folder_, std::strerror(errno)));
}

GateMesher::~GateMesher() {
  std::error_code error;
  fs::remove_all(folder_, error);
}

std::vector<std::string> GateMesher::command(const std::string& podm, const GateTrial& trial,
                                             int threads) const {
  return {podm,
          "mesh",
          trial.image,
          "--radius",
          fmt::format("{}", trial.radius_mm),
          "--threads",
          std::to_string(threads),
          "--output",
          folder_ + "/mesh.vtu",
          "--record",
          folder_ + "/record.jsonl",
          "--quiet"};
}

Reply GateMesher::run(const std::vector<std::string>& arguments) const {
  Reply reply = ask(arguments, kTimeoutS, stop_requested_);
  using End = ProcessOutcome::End;
  if (reply.outcome.end == End::kNotStarted || reply.outcome.end == End::kInterrupted)
    throw InputError(fmt::format("{}: {}", arguments.front(), reply.outcome.describe()));
  return reply;
}

MesherRun GateMesher::mesh(const std::string& podm, const GateTrial& trial, int threads, bool verify) const {
  warm_memory(kWarmBytesOfGate);
  std::error_code error;
  fs::remove(folder_ + "/record.jsonl", error);
  auto arguments = command(podm, trial, threads);
  if (verify) arguments.push_back("--verify");
  MesherRun run{.process = this->run(arguments).outcome, .record = {}};
  std::ifstream file(folder_ + "/record.jsonl");
  try {
    if (file) run.record = from_json<MeshRecord>(Json::parse(file, nullptr, false));
  } catch (const FieldError& fault) {
    throw InputError(fmt::format("{}: the record of {}: {}", podm, trial.image, fault.what()));
  }
  return run;
}

MesherRun GateMesher::mesh_or_throw(const std::string& podm, const GateTrial& trial, int threads) const {
  MesherRun run = mesh(podm, trial, threads, false);
  if (!run.process.succeeded() || !run.record)
    throw InputError(fmt::format("{} on {}: {}", podm, trial.image, run.process.describe()));
  return run;
}

std::uint64_t GateMesher::count_instructions(const std::string& podm, const GateTrial& trial) const {
  std::vector<std::string> arguments{"valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"};
  for (const std::string& argument : command(podm, trial, 1)) arguments.push_back(argument);
  const Reply reply = run(arguments);
  const std::string key = "Collected : ";
  const auto found = reply.messages.rfind(key);
  if (!reply.succeeded() || found == std::string::npos)
    throw InputError(fmt::format("callgrind counts no instructions of {} on {}: {}", podm, trial.image,
                                 reply.failure_text()));
  return std::stoull(reply.messages.substr(found + key.size()));
}

}  // namespace podm::bench
