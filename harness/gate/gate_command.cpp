#include "gate/gate_command.h"

#include <fmt/format.h>

#include "gate/compare.h"
#include "gate/gate_budget.h"
#include "gate/gate_evidence.h"
#include "process/stop_request.h"
#include "rows/codec.h"
#include "rows/results_file.h"

namespace podm::bench {
namespace {

constexpr int kExitWorse = 1;

void print_tries(const std::vector<GateTries>& tries, const std::string& json_path) {
  fmt::print("{}", table_of(tries));
  if (json_path.empty()) return;
  std::string lines;
  for (const GateTries& row : tries) lines += to_json(row).dump() + "\n";
  write_file(json_path, lines);
}

}  // namespace

int run_gate(const GateOptions& options, bool renews) {
  const StopQuery stop_requested = stop_on_signals();
  if (!renews) return gate(options, stop_requested) ? 0 : kExitWorse;
  renew_budgets(options, stop_requested);
  return 0;
}

int gate_evidence(const EvidenceCommand& command) {
  if (command.num_rounds > 0)
    record_gate_rounds({.podm = command.podm,
                        .rounds_path = command.rounds_path,
                        .trial = read_budgets(command.budgets_path).timed,
                        .num_rounds = command.num_rounds,
                        .order_seed = command.order_seed},
                       stop_on_signals());
  print_tries(measured_tries(read_gate_rounds(command.rounds_path)), command.json_path);
  return 0;
}

int gate_simulation(int num_tries, const std::string& json_path) {
  print_tries(simulated_tries(num_tries), json_path);
  return 0;
}

int compare_files(const std::string& before, const std::string& after) {
  const Comparison comparison = compare(read_record_file(before), read_record_file(after));
  fmt::print("{}", comparison.text);
  return comparison.is_worse ? kExitWorse : 0;
}

}  // namespace podm::bench
