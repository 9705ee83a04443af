#include "gate/gate_command.h"

#include <fmt/format.h>

#include "gate/compare.h"
#include "trials/stop_request.h"

namespace podm::bench {
namespace {

constexpr int kExitWorse = 1;

}  // namespace

int run_gate(const GateOptions& options, bool renews) {
  const StopQuery stop_requested = stop_on_signals();
  if (!renews) return gate(options, stop_requested) ? 0 : kExitWorse;
  renew_budgets(options, stop_requested);
  return 0;
}

int compare_files(const std::string& before, const std::string& after) {
  const Comparison comparison = compare(read_record_file(before), read_record_file(after));
  fmt::print("{}", comparison.text);
  return comparison.is_worse ? kExitWorse : 0;
}

}  // namespace podm::bench
