// The commands of podm-bench that judge a change, and those that judge the judge. Each returns the exit code;
// all throw InputError.
#pragma once

#include <string>

#include "gate/gate.h"

namespace podm::bench {

/// Judges the head; with `renews`, puts what the head does into the file of budgets instead.
int run_gate(const GateOptions& options, bool renews);

struct EvidenceCommand {
  std::string rounds_path;                  ///< JSON lines of recorded rounds
  std::string podm;                         ///< the mesher that more rounds are recorded of
  std::string budgets_path = kBudgetsPath;  ///< names the trial that is timed
  int num_rounds = 0;                       ///< to record before the tries; 0: none
  std::uint64_t order_seed = 1;             ///< draws the order within rounds
  std::string json_path;  ///< the counts are also written to it as JSON lines; empty: nowhere
};

/// Tries the rule about seconds on recorded rounds and prints how often it gave which answer.
int gate_evidence(const EvidenceCommand& command);
/// The same on a simulated machine, so many tries per noise and planted slowdown.
int gate_simulation(int num_tries, const std::string& json_path);

/// Two files of records, before and after.
int compare_files(const std::string& before, const std::string& after);

}  // namespace podm::bench
