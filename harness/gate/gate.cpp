#include "gate/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <thread>

#include "gate/gate_budget.h"
#include "gate/gate_mesher.h"
#include "gate/gate_slowdown.h"

namespace podm::bench {
namespace {

void say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);  // the next line may be minutes away
}

// The verdicts that the mesher had from podm-verify.
ByName<Proof> verdicts_of(const MesherRun& run) {
  return run.record ? run.record->verdicts.value_or(ByName<Proof>{}) : ByName<Proof>{};
}

// Why the mesh is not proved; empty: every claim passes.
std::string unproved(const MesherRun& run) {
  const ByName<Proof> verdicts = verdicts_of(run);
  std::string text;
  for (const auto& [claim, verdict] : verdicts)
    if (verdict != Proof::kPass) text += fmt::format("claim {}: {}; ", claim, to_string(verdict));
  if (verdicts.empty()) text += "no verdicts; ";
  return run.process.succeeded() && text.empty() ? "" : text + run.process.describe();
}

// The mesh is proved already.
Budget measure(const GateTrial& trial, const MesherRun& run, const std::string& podm,
               const GateMesher& mesher) {
  return {trial, work_of(*run.record), mesher.count_instructions(podm, trial)};
}

bool instructions_fit(const Budgets& budgets, const Budget& budget, std::uint64_t counted) {
  const double ratio = static_cast<double>(counted) / static_cast<double>(budget.instructions);
  const std::string text =
      fmt::format("{}: {} instructions, {:.4f} of the budget", budget.trial.name, counted, ratio);
  if (budgets.build != this_build()) {
    say(fmt::format("  {}, not compared: the budget is of {}", text, budgets.build));
    return true;
  }
  const bool fits = ratio <= 1 + budgets.instructions_tolerance;
  const bool is_loose = ratio < 1 - budgets.instructions_tolerance;
  say(fmt::format("  {}{}{}", fits ? "" : "BLOCKS ", text, is_loose ? ", to be renewed" : ""));
  return fits;
}

bool trial_passes(const Budgets& budgets, const Budget& budget, const std::string& podm,
                  const GateMesher& mesher) {
  const MesherRun run = mesher.mesh(podm, budget.trial, 1, true);
  if (const std::string fault = unproved(run); !fault.empty()) {
    say(fmt::format("  BLOCKS {}: {}", budget.trial.name, fault));
    return false;
  }
  const Budget now = measure(budget.trial, run, podm, mesher);
  const auto texts = differences(budget.work, now.work);
  for (const std::string& text : texts) say(fmt::format("  BLOCKS {}: {}", budget.trial.name, text));
  if (texts.empty())
    say(fmt::format("  {}: {} claims pass, work as committed", budget.trial.name, verdicts_of(run).size()));
  return instructions_fit(budgets, budget, now.instructions) && texts.empty();
}

bool work_passes(const Budgets& budgets, const std::string& podm, const GateMesher& mesher) {
  say("Tier 1, blocks always: claims, deterministic work and instructions of one thread");
  bool passes = true;
  for (const Budget& budget : budgets.budgets) passes = trial_passes(budgets, budget, podm, mesher) && passes;
  return passes;
}

MesherRun mesh_or_throw(const std::string& podm, const GateTrial& trial, int threads,
                        const GateMesher& mesher) {
  MesherRun run = mesher.mesh(podm, trial, threads, false);
  if (!run.process.succeeded() || !run.record)
    throw InputError(fmt::format("{} on {}: {}", podm, trial.image, run.process.describe()));
  return run;
}

// Processor seconds, not those of the clock: other programs of a shared machine lengthen these most.
bool speed_passes(const GateTrial& trial, const GateOptions& options, const GateMesher& mesher) {
  say(fmt::format("Tier 2, blocks with evidence: processor seconds of {} on one thread, base twice and head",
                  trial.name));
  std::mt19937_64 random(options.order_seed);
  const auto next_round = [&] {
    enum { kBase, kBaseAgain, kHead };
    std::array<int, 3> order{kBase, kBaseAgain, kHead};
    std::shuffle(order.begin(), order.end(), random);
    std::array<double, 3> seconds{};
    for (const int which : order)
      seconds[static_cast<std::size_t>(which)] =
          mesh_or_throw(which == kHead ? options.head : options.base, trial, 1, mesher).cpu_s();
    say(fmt::format("  {:.3f} {:.3f} | {:.3f}", seconds[kBase], seconds[kBaseAgain], seconds[kHead]));
    return Round{seconds[kBase], seconds[kBaseAgain], seconds[kHead]};
  };
  const Slowdown slowdown = measure_slowdown(next_round);
  const bool blocks = slowdown.answer == Answer::kSlower;
  say(fmt::format("  {}{}: head/base {:.3f} [{:.3f}, {:.3f}], base/base {:.3f} [{:.3f}, {:.3f}], {} rounds",
                  blocks ? "BLOCKS " : "", to_string(slowdown.answer), slowdown.head.value, slowdown.head.low,
                  slowdown.head.high, slowdown.noise.value, slowdown.noise.low, slowdown.noise.high,
                  slowdown.num_rounds));
  return !blocks;
}

// Numbers of operations; 0 where the record does not tell.
std::pair<double, double> commits_and_conflicts(const MeshRecord& record) {
  const OutcomesRecord outcomes = record.outcomes.value_or(OutcomesRecord{});
  return {outcomes.committed.value_or(0), outcomes.lock_conflict.value_or(0)};
}

void print_scaling(const GateTrial& trial, const std::string& podm, const GateMesher& mesher) {
  const int all = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  say(fmt::format("Tier 3, advises: {} at 1 and at {} threads", trial.name, all));
  double one_thread = 0;
  for (const int threads : {1, all}) {
    const MeshRecord record = *mesh_or_throw(podm, trial, threads, mesher).record;
    const double speed = record.refine_cells_per_second;
    if (threads == 1) one_thread = speed;
    const auto [committed, conflicts] = commits_and_conflicts(record);
    say(fmt::format(
        "  {} threads: {:.0f} refined cells/s, {:.2f} of one thread; {:.4f} rollbacks a commit; "
        "seconds lost {}",
        threads, speed, speed / one_thread, conflicts / committed, to_json(record.overhead_s).dump()));
  }
}

}  // namespace

bool gate(const GateOptions& options, const StopQuery& stop_requested) {
  const Budgets budgets = read_budgets(options.budgets_path);
  const GateMesher mesher(stop_requested);
  const auto is_asked = [&](int tier) { return std::ranges::count(options.tiers, tier) > 0; };
  bool passes = true;
  if (is_asked(1)) passes = work_passes(budgets, options.head, mesher);
  if (is_asked(2) && !options.base.empty()) passes = speed_passes(budgets.timed, options, mesher) && passes;
  if (is_asked(3)) print_scaling(budgets.timed, options.head, mesher);
  say(passes ? "The gate is open" : "The gate is shut");
  return passes;
}

void renew_budgets(const GateOptions& options, const StopQuery& stop_requested) {
  Budgets budgets = read_budgets(options.budgets_path);
  const GateMesher mesher(stop_requested);
  for (Budget& budget : budgets.budgets) {
    const MesherRun run = mesher.mesh(options.head, budget.trial, 1, true);
    if (const std::string fault = unproved(run); !fault.empty())
      throw InputError(fmt::format("{}: {}", budget.trial.name, fault));
    const Budget now = measure(budget.trial, run, options.head, mesher);
    for (const std::string& text : differences(budget.work, now.work))
      say(fmt::format("{}: {}", budget.trial.name, text));
    say(fmt::format("{}: {} instructions, committed {}", budget.trial.name, now.instructions,
                    budget.instructions));
    budget = now;
  }
  budgets.build = this_build();
  write_budgets(budgets, options.budgets_path);
}

}  // namespace podm::bench
