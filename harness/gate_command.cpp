#include "gate_command.h"

#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <memory>

#include "compare.h"
#include "gate.h"

namespace podm::bench {
namespace {

constexpr int kExitWorse = 1;

std::atomic<bool> interrupted = false;

void on_signal(int) { interrupted = true; }

}  // namespace

void add_gate(CLI::App& program, const std::string& podm, int& exit_code) {
  struct State {
    GateOptions options;
    bool renew = false;
  };
  const auto state = std::make_shared<State>();
  GateOptions& options = state->options;
  options.head = podm;
  CLI::App& app =
      *program.add_subcommand("gate", "judge a change of the mesher; exits with 1 when it may not go in");
  app.add_option("--head", options.head, "file of the mesher to judge [default: podm beside this program]");
  app.add_option("--base", options.base,
                 "file of the mesher before the change [default: compare no seconds]");
  app.add_option("--tier", options.tiers, "1 work, 2 seconds, 3 scaling; repeatable [default: all]")
      ->check(CLI::Range(1, 3));
  app.add_option("--budgets", options.budgets_path, "committed work [default: ci/gate_budgets.json]");
  app.add_option("--order-seed", options.order_seed, "of the order within each round [default: 1]");
  app.add_flag("--renew", state->renew, "put what the head does into the file of budgets [default: judge]");
  app.callback([state, &exit_code] {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    const auto stop_requested = [] { return interrupted.load(); };
    if (state->renew)
      renew_budgets(state->options, stop_requested);
    else
      exit_code = gate(state->options, stop_requested) ? 0 : kExitWorse;
  });
}

void add_compare(CLI::App& program, int& exit_code) {
  const auto paths = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App& app =
      *program.add_subcommand("compare", "compare two files of records; exits with 1 when B is worse");
  app.add_option("A", paths->first, "JSON lines of the program before")->required();
  app.add_option("B", paths->second, "JSON lines of the program after")->required();
  app.callback([paths, &exit_code] {
    const Comparison comparison = compare(read_record_file(paths->first), read_record_file(paths->second));
    fmt::print("{}", comparison.text);
    exit_code = comparison.is_worse ? kExitWorse : 0;
  });
}

}  // namespace podm::bench
