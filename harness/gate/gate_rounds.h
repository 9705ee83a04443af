// Rounds of a mesher against itself with planted slowdowns. They are recorded so that the gate's rule can be
// tried on the behaviour of a real machine. One JSON line per round, in the order in which the rounds ran.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gate/gate_mesher.h"
#include "rows/row.h"

namespace podm::bench {

/// The slowdowns that each round plants, in percent.
inline constexpr std::array kPlantedPercent{0, 3, 5, 7, 10};

/// One process of a round.
struct GateProcess {
  bool is_head = false;  ///< one process of each round is the base
  int planted_percent = 0;
  double cpu_s = 0, wall_s = 0;  ///< with the planted seconds
  static constexpr auto fields() { return PODM_FIELDS(GateProcess, is_head, planted_percent, cpu_s, wall_s); }
};

/// Computes on this thread for the planted share of the process's processor seconds, and adds the seconds
/// that this took to both clocks of the process.
void plant(GateProcess& process);

struct GateRound {
  static constexpr int kSchema = 1;
  int schema = kSchema;
  int round = 1;                 ///< number in the file
  std::uint64_t order_seed = 1;  ///< seed of the order of the processes
  GateTrial trial;
  std::vector<GateProcess> processes;  ///< in the order in which they ran
  ProgramRecord podm;
  EnvironmentRecord environment;
  static constexpr auto fields() {
    return PODM_FIELDS(GateRound, schema, round, order_seed, trial, processes, podm, environment);
  }
};

/// Returns the rounds of a file. Throws InputError "file:line: fault" for a line that is not a complete
/// round, and for a round of another machine, mesher or trial than the first.
std::vector<GateRound> read_gate_rounds(const std::string& path);

struct RecordingOptions {
  std::string podm, rounds_path;
  GateTrial trial;
  int num_rounds = 0;
  std::uint64_t order_seed = 1;
};

/// Appends rounds to the file, which is created if absent. A round runs the mesher once as the base and once
/// per planted slowdown. This process itself spends the planted part of a process's processor seconds, right
/// after the process has ended. Throws InputError, also when the user stops it; earlier rounds are kept.
void record_gate_rounds(const RecordingOptions& options, const StopQuery& stop_requested);

}  // namespace podm::bench
