#include "gate/gate_rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "gate/drawn_order.h"
#include "machine/environment.h"
#include "process/stopwatch.h"
#include "rows/codec.h"
#include "rows/machine_state.h"
#include "rows/results_file.h"

namespace podm::bench {
namespace {

double cpu_seconds_of_this_thread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<GateProcess> processes_of_a_round() {
  std::vector<GateProcess> processes{GateProcess{}};
  for (const int percent : kPlantedPercent)
    processes.push_back({.is_head = true, .planted_percent = percent});
  return processes;
}

void run(GateProcess& process, const RecordingOptions& options, const GateMesher& mesher) {
  const ProcessOutcome outcome = mesher.mesh_or_throw(options.podm, options.trial, 1).process;
  process.cpu_s = outcome.user_s + outcome.system_s;
  process.wall_s = outcome.wall_s;
  plant(process);
}

// Returns the reason why two rounds cannot belong to one series; empty: they can.
std::string difference(const GateRound& round, const GateRound& first) {
  Row of_round, of_first;
  of_round.environment = round.environment;
  of_first.environment = first.environment;
  if (!same_machine(of_round, of_first)) return "another machine";
  if (round.podm.sha256 != first.podm.sha256) return "another mesher";
  return round.trial == first.trial ? "" : "another trial";
}

// Returns the fault of a round that this program did not record; empty: it is a valid round.
std::string fault_of(const GateRound& round) {
  if (round.schema != GateRound::kSchema) return fmt::format("is not of schema {}", GateRound::kSchema);
  if (round.processes.size() != kPlantedPercent.size() + 1) return "has another number of processes";
  for (const GateProcess& asked : processes_of_a_round()) {
    const auto is_asked = [&](const GateProcess& process) {
      return process.is_head == asked.is_head && process.planted_percent == asked.planted_percent &&
             process.cpu_s > 0 && process.wall_s > 0;
    };
    if (std::ranges::count_if(round.processes, is_asked) != 1)
      return fmt::format("must have one {} with {} % planted, and its seconds",
                         asked.is_head ? "head" : "base", asked.planted_percent);
  }
  return "";
}

GateRound next_round(const RecordingOptions& options, const GateMesher& mesher, DrawnOrder& order,
                     GateRound round) {
  renew(round.environment);
  round.processes.clear();
  const std::vector<GateProcess> processes = processes_of_a_round();
  for (const std::size_t index : order.next()) {
    round.processes.push_back(processes[index]);
    run(round.processes.back(), options, mesher);
  }
  return round;
}

}  // namespace

void plant(GateProcess& process) {
  const double asked_s = process.cpu_s * process.planted_percent / 100;
  if (asked_s == 0) return;
  const Stopwatch watch;
  const double start_s = cpu_seconds_of_this_thread();
  double taken_s = 0;
  while (taken_s < asked_s) taken_s = cpu_seconds_of_this_thread() - start_s;
  process.cpu_s += taken_s;
  process.wall_s += watch.seconds();
}

std::vector<GateRound> read_gate_rounds(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("cannot read {}", path));
  std::vector<GateRound> rounds;
  for (std::string line; std::getline(file, line);) {
    const auto fail = [&](const std::string& fault) {
      throw InputError(fmt::format("{}:{}: {}", path, rounds.size() + 1, fault));
    };
    try {
      rounds.push_back(from_json<GateRound>(Json::parse(line)));
    } catch (const std::exception& fault) {
      fail(fault.what());
    }
    const std::string fault = fault_of(rounds.back()), other = difference(rounds.back(), rounds.front());
    if (!fault.empty() || !other.empty()) {
      const std::string text = fault.empty() ? "is of " + other + " than the first line" : fault;
      throw InputError(fmt::format("{}:{}: {}", path, rounds.size(), text));
    }
  }
  return rounds;
}

void record_gate_rounds(const RecordingOptions& options, const StopQuery& stop_requested) {
  GateRound round{.order_seed = options.order_seed,
                  .trial = options.trial,
                  .processes = {},
                  .podm = describe_programs({.podm = options.podm, .verifier = {}}).podm,
                  .environment = environment_of_run(this_machine().summary)};
  if (std::filesystem::exists(options.rounds_path)) {
    const std::vector<GateRound> known = read_gate_rounds(options.rounds_path);
    round.round += static_cast<int>(known.size());
    const std::string other = known.empty() ? "" : difference(round, known.front());
    if (!other.empty()) throw InputError(fmt::format("{} is of {}", options.rounds_path, other));
  }
  const GateMesher mesher(stop_requested);
  RecordFile file(options.rounds_path);
  DrawnOrder order(kPlantedPercent.size() + 1, options.order_seed + static_cast<std::uint64_t>(round.round));
  for (int i = 0; i < options.num_rounds; ++i, ++round.round) {
    round = next_round(options, mesher, order, round);
    file.append_text(to_json(round).dump() + "\n");
    fmt::print(stderr, "round {} recorded, {} of {}\n", round.round, i + 1, options.num_rounds);
  }
}

}  // namespace podm::bench
