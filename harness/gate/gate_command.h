// Commands of podm-bench that judge a change, and commands that test the gate's rule. Each returns the exit
// code; all throw InputError.
#pragma once

#include <string>

#include "gate/gate.h"

namespace podm::bench {

/// Judges the head. With `renews`, writes the head's work into the file of budgets instead.
int run_gate(const GateOptions& options, bool renews);

struct EvidenceCommand {
  std::string rounds_path;                  ///< JSON lines of recorded rounds
  std::string podm;                         ///< the mesher of further rounds
  std::string budgets_path = kBudgetsPath;  ///< names the trial that is timed
  int num_rounds = 0;                       ///< to record before the tries; 0: none
  std::uint64_t order_seed = 1;             ///< seed of the order within rounds
  std::string json_path;  ///< the counts are also written to it as JSON lines; empty: they are not
};

/// Tries the rule about seconds on recorded rounds and prints the number of each answer.
int gate_evidence(const EvidenceCommand& command);
/// Tries the rule on a simulated machine, `num_tries` times per noise and planted slowdown.
int gate_simulation(int num_tries, const std::string& json_path);

/// Compares two files of records, before and after.
int compare_files(const std::string& before, const std::string& after);

}  // namespace podm::bench
