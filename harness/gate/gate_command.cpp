#include "gate/gate_command.h"

#include <fmt/format.h>

#include <atomic>
#include <csignal>

#include "gate/compare.h"

namespace podm::bench {
namespace {

constexpr int kExitWorse = 1;

std::atomic<bool> interrupted = false;

void on_signal(int) { interrupted = true; }

}  // namespace

int run_gate(const GateOptions& options, bool renews) {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const auto stop_requested = [] { return interrupted.load(); };
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
