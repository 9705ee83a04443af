#include "gate/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "errors.h"
#include "gate/drawn_order.h"
#include "gate/gate_budget.h"
#include "gate/gate_mesher.h"
#include "gate/gate_slowdown.h"
#include "rows/codec.h"

namespace podm::bench {
namespace {

void say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);  // the next line may come minutes later
}

// Returns the verdicts of podm-verify in the mesher's record.
ByName<Proof> verdicts_of(const MesherRun& run) {
  return run.record ? run.record->verdicts.value_or(ByName<Proof>{}) : ByName<Proof>{};
}

// Returns the reason why the mesh is not proved; empty: every claim passes.
std::string unproved(const MesherRun& run) {
  const ByName<Proof> verdicts = verdicts_of(run);
  std::string text;
  for (const auto& [claim, verdict] : verdicts)
    if (verdict != Proof::kPass) text += fmt::format("claim {}: {}; ", claim, to_string(verdict));
  if (verdicts.empty()) text += "no verdicts; ";
  return run.process.succeeded() && text.empty() ? "" : text + run.process.describe();
}

// The mesh must be proved already.
Budget measure(const GateTrial& trial, const MesherRun& run, const std::string& podm,
               const GateMesher& mesher) {
  return {trial, work_of(*run.record), mesher.count_instructions(podm, trial)};
}

bool instructions_fit(const Budgets& budgets, const Budget& budget, std::uint64_t counted) {
  const double ratio = static_cast<double>(counted) / static_cast<double>(budget.instructions);
  const std::string text =
      fmt::format("{}: {} instructions, {:.4f} of the budget", budget.trial.name, counted, ratio);
  if (budgets.build != this_build()) {
    say(fmt::format("  {}, not compared: the budget is for {}", text, budgets.build));
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

std::string text_of(const CentreEstimate& ratio) {
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", ratio.value, ratio.low, ratio.high);
}

// Returns the answer in words, with its consequence. If there is no answer, predicts the number of rounds for
// one.
std::string text_of(const Slowdown& slowdown) {
  const std::string text =
      fmt::format("{}: head/base {} by processor seconds, {} rounds", to_string(slowdown.answer),
                  text_of(slowdown.ratio), slowdown.num_rounds);
  if (slowdown.answer == Answer::kSlower) return "BLOCKS " + text;
  if (slowdown.answer == Answer::kNotSlower) return text;
  return fmt::format("{}; blocks nothing; an answer would take about {:.0f} rounds", text,
                     slowdown.rounds_for_an_answer());
}

// Decides by processor seconds, because other programs of a shared machine lengthen wall seconds more.
bool speed_passes(const GateTrial& trial, const GateOptions& options, const GateMesher& mesher) {
  say(fmt::format("Tier 2, blocks with evidence: processor and wall seconds of {} on one thread, base | head",
                  trial.name));
  DrawnOrder order(2, options.order_seed);
  std::vector<Round> by_processor, by_clock;
  const auto next_round = [&] {
    Round& cpu = by_processor.emplace_back();
    Round& wall = by_clock.emplace_back();
    for (const std::size_t process : order.next()) {
      const bool is_base = process == 0;
      const MesherRun run = mesher.mesh_or_throw(is_base ? options.base : options.head, trial, 1);
      (is_base ? cpu.base_s : cpu.head_s) = run.cpu_s();
      (is_base ? wall.base_s : wall.head_s) = run.process.wall_s;
    }
    say(fmt::format("  {:.3f} {:.3f} | {:.3f} {:.3f}", cpu.base_s, wall.base_s, cpu.head_s, wall.head_s));
    return std::optional(cpu);
  };
  const Slowdown slowdown = measure_slowdown(next_round).value();
  say("  " + text_of(slowdown));
  say(fmt::format("  By wall seconds, which decide nothing: head/base {}",
                  text_of(head_over_base(by_clock))));
  return slowdown.answer != Answer::kSlower;
}

// Returns the numbers of operations; 0 if the record does not have them.
std::pair<double, double> commits_and_conflicts(const MeshRecord& record) {
  const OutcomesRecord outcomes = record.outcomes.value_or(OutcomesRecord{});
  return {outcomes.committed.value_or(0), outcomes.lock_conflict.value_or(0)};
}

void print_scaling(const GateTrial& trial, const std::string& podm, const GateMesher& mesher) {
  const int all = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  say(fmt::format("Tier 3, advises: {} at 1 and at {} threads", trial.name, all));
  double one_thread = 0;
  for (const int threads : {1, all}) {
    const MeshRecord record = *mesher.mesh_or_throw(podm, trial, threads).record;
    const double speed = record.refine_cells_per_second;
    if (threads == 1) one_thread = speed;
    const auto [committed, conflicts] = commits_and_conflicts(record);
    say(fmt::format(
        "  {} threads: {:.0f} refined cells/s, {:.2f} of one thread; {:.4f} rollbacks per commit; "
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
