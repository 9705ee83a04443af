#include "experiments/plan.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "experiments/claim_names.h"
#include "experiments/image_folder.h"
#include "options/option_matrix.h"

namespace podm::bench {
namespace {

bool is_chosen(const Trial& trial, const RunCommand& command) {
  return (command.only.empty() || fnmatch(command.only.c_str(), trial.name.c_str(), 0) == 0) &&
         (!command.tier || trial.tier <= *command.tier);
}

FinishedRows finished_rows(const std::vector<Row>& rows) {
  FinishedRows finished;
  for (const Row& row : rows)
    if (is_finished(row)) finished[row.key] = row;
  return finished;
}

// Names of images distinguish trials, both of phantoms and of files. Two images must therefore not have the
// same name.
void check_images(const std::vector<std::string>& images) {
  std::map<std::string, std::string> by_name;
  for (const std::string& image : images) {
    if (!is_phantom(image) && !std::filesystem::exists(image))
      throw InputError(fmt::format("--image {}: no such file", image));
    const auto [known, is_new] = by_name.emplace(in_name(image), image);
    if (!is_new)
      throw InputError(fmt::format("--image {} and --image {} have the same name", known->second, image));
  }
}

}  // namespace

std::size_t Plan::num_present() const {
  return static_cast<std::size_t>(
      std::count_if(turns.begin(), turns.end(), [](const PlannedTurn& planned) { return planned.row; }));
}

std::vector<Experiment> read_experiments(const RunCommand& command) {
  const std::vector<std::string> images = with_images_of_folders(command.images);
  check_images(images);
  std::vector<Experiment> experiments;
  for (const std::string& path : command.experiment_paths)
    experiments.push_back(read_experiment(path, images));
  check_claim_names(experiments);
  for (const Experiment& experiment : experiments)
    for (const Trial& trial : experiment.trials)
      if (is_chosen(trial, command)) return experiments;
  throw InputError(fmt::format("{}: no trial matches{}{}", fmt::join(command.experiment_paths, ", "),
                               command.only.empty() ? "" : fmt::format(" --only '{}'", command.only),
                               command.tier ? " --tier " + to_string(*command.tier) : ""));
}

std::string rows_path(const std::string& results_folder, const Experiment& experiment) {
  return fmt::format("{}/{}.jsonl", results_folder, experiment.name);
}

Plan make_plan(const RunCommand& command, const Experiment& experiment, const std::vector<Row>& rows,
               Preparer& preparer, TrialKeys& keys) {
  Plan plan;
  const Expectations expectations(experiment, rows);
  std::vector<std::optional<Preparation>> prepared;
  for (const Trial& trial : experiment.trials) {
    if (!is_chosen(trial, command)) continue;
    plan.trials.push_back(trial);
    plan.expected.push_back(expectations.of(trial));
    prepared.push_back(preparer.find(trial));
  }
  if (!command.again) plan.finished = finished_rows(rows);
  for (const Turn& turn : schedule(plan.trials, command.order_seed)) {
    PlannedTurn planned{turn, {}, {}};
    if (const auto& preparation = prepared[turn.trial])
      planned.key = keys.of(plan.trials[turn.trial], turn, *preparation);
    const auto found = plan.finished.find(planned.key);
    if (found != plan.finished.end()) planned.row = found->second;
    plan.turns.push_back(std::move(planned));
  }
  return plan;
}

}  // namespace podm::bench
