#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "experiments/commands.h"
#include "experiments/plan.h"
#include "experiments/progress.h"
#include "machine/machine.h"
#include "options/option_matrix.h"
#include "process/sha256.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

constexpr double kBytesPerMib = 1024.0 * 1024;
constexpr const char* kUnknown = "-";

std::string mebibytes(const std::optional<double>& bytes) {
  return bytes ? fmt::format("{:.0f}", *bytes / kBytesPerMib) : kUnknown;
}

// The numbers of turns of one trial: all of them, and those still to run.
struct TurnCount {
  std::size_t all = 0, to_run = 0;
};

std::vector<TurnCount> counts_of(const Plan& plan) {
  std::vector<TurnCount> counts(plan.trials.size());
  for (const PlannedTurn& planned : plan.turns) {
    ++counts[planned.turn.trial].all;
    counts[planned.turn.trial].to_run += !planned.row;
  }
  return counts;
}

// Returns the options, with the radius if it is known already.
Json options_of(const Trial& trial, Preparer& preparer) {
  const auto preparation = preparer.find(trial);
  return preparation ? resolved_options(trial, *preparation) : trial.options;
}

void print_matrix(const Plan& plan, const std::vector<TurnCount>& counts, Preparer& preparer) {
  std::vector<std::vector<std::string>> lines{
      {"trial", "input", "runs", "to run", "s/run", "MiB", "mesh MiB", "options"}};
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    const Expectation& expected = plan.expected[i];
    const std::string image = std::filesystem::path(trial.image).filename().string();
    lines.push_back({trial.name, trial.if_exists && !image_exists(trial) ? image + " (absent)" : image,
                     std::to_string(counts[i].all), std::to_string(counts[i].to_run),
                     expected.seconds ? fmt::format("{:.1f}", *expected.seconds) : kUnknown,
                     mebibytes(expected.memory_bytes), mebibytes(expected.disk_bytes),
                     fmt::format("{}", fmt::join(mesher_arguments(options_of(trial, preparer)), " "))});
  }
  fmt::print("{}", align(lines, 2));
}

// Adds the seconds of all turns still to run. Memory and disk are those of the largest turn, as one turn runs
// at a time.
Expectation total_of(const Plan& plan, const std::vector<TurnCount>& counts) {
  Expectation total;
  const auto keep_largest = [](std::optional<double>& largest, const std::optional<double>& value) {
    if (value) largest = std::max(largest.value_or(0), *value);
  };
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    if (counts[i].to_run == 0) continue;
    const Expectation& expected = plan.expected[i];
    if (expected.seconds)
      total.seconds = total.seconds.value_or(0) + *expected.seconds * static_cast<double>(counts[i].to_run);
    keep_largest(total.memory_bytes, expected.memory_bytes);
    keep_largest(total.disk_bytes, expected.disk_bytes);
  }
  return total;
}

// A folder that does not exist yet has the free space of its nearest existing parent.
std::optional<double> free_bytes(std::filesystem::path folder) {
  std::error_code error;
  folder = std::filesystem::absolute(folder, error);
  while (!std::filesystem::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  const auto space = std::filesystem::space(folder, error);
  return error ? std::nullopt : std::optional<double>(static_cast<double>(space.available));
}

void print_total(const Plan& plan, const std::vector<TurnCount>& counts, const std::string& results_folder) {
  const Expectation total = total_of(plan, counts);
  fmt::print("{} runs, {} to do: time {}; memory {} MiB; disk {} MiB, {} MiB free\n", plan.turns.size(),
             plan.turns.size() - plan.num_present(),
             total.seconds ? print_duration(*total.seconds) : kUnknown, mebibytes(total.memory_bytes),
             mebibytes(total.disk_bytes), mebibytes(free_bytes(results_folder)));
}

}  // namespace

int dry_run(const RunCommand& command) {
  const std::vector<Experiment> experiments = read_experiments(command);
  const std::string mesher_sha256 = sha256_of_file(command.programs.podm);
  TrialKeys keys(mesher_sha256, this_machine().summary, Peers(command.programs.peers, command.programs.podm),
                 command.programs.podm);
  Preparer preparer(command.programs.podm, mesher_sha256, command.results_folder);
  for (const Experiment& experiment : experiments) {
    const Plan plan = make_plan(
        command, experiment, read_rows(rows_path(command.results_folder, experiment)).rows, preparer, keys);
    if (plan.turns.empty()) continue;
    const std::vector<TurnCount> counts = counts_of(plan);
    fmt::print("{}\n", experiment.title);
    print_matrix(plan, counts, preparer);
    print_total(plan, counts, command.results_folder);
  }
  return 0;
}

}  // namespace podm::bench
