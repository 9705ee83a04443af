#include "plan.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <filesystem>

#include "record.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

bool is_chosen(const Trial& trial, const RunCommand& command) {
  return (command.only.empty() || fnmatch(command.only.c_str(), trial.name.c_str(), 0) == 0) &&
         (!command.tier || trial.tier <= *command.tier);
}

// The newest finished row of each key; rows of schema 1 have none.
std::map<std::string, const Json*> finished_rows(const std::vector<Json>& rows) {
  std::map<std::string, const Json*> finished;
  for (const Json& row : rows)
    if (is_finished(row)) finished[text_in(row, "key")] = &row;
  finished.erase("");
  return finished;
}

}  // namespace

std::size_t Plan::num_present() const {
  return static_cast<std::size_t>(
      std::count_if(turns.begin(), turns.end(), [](const PlannedTurn& planned) { return planned.row; }));
}

std::vector<Experiment> read_experiments(const RunCommand& command) {
  if (!command.image.empty() && !is_phantom(command.image) && !std::filesystem::exists(command.image))
    throw InputError(fmt::format("--image {}: no such file", command.image));
  std::vector<Experiment> experiments;
  for (const std::string& path : command.experiment_paths)
    experiments.push_back(read_experiment(path, command.image));
  for (const Experiment& experiment : experiments)
    for (const Trial& trial : experiment.trials)
      if (is_chosen(trial, command)) return experiments;
  throw InputError(fmt::format("{}: no trial matches{}{}", fmt::join(command.experiment_paths, ", "),
                               command.only.empty() ? "" : fmt::format(" --only '{}'", command.only),
                               command.tier ? " --tier " + to_string(*command.tier) : ""));
}

std::string rows_path(const RunCommand& command, const Experiment& experiment) {
  return fmt::format("{}/{}.jsonl", command.results_folder, experiment.name);
}

Plan make_plan(const RunCommand& command, const Experiment& experiment, const std::vector<Json>& rows,
               TrialKeys& keys) {
  Plan plan;
  const Expectations expectations(experiment, rows);
  for (const Trial& trial : experiment.trials) {
    if (!is_chosen(trial, command)) continue;
    plan.trials.push_back(trial);
    plan.expected.push_back(expectations.of(trial));
  }
  const auto finished = finished_rows(rows);
  for (const Turn& turn : schedule(plan.trials, command.order_seed)) {
    PlannedTurn planned{turn, keys.of(plan.trials[turn.trial], turn), {}};
    const auto found = finished.find(planned.key);
    if (found != finished.end() && !command.again) planned.row = *found->second;
    plan.turns.push_back(std::move(planned));
  }
  return plan;
}

}  // namespace podm::bench
