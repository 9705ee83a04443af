#include <fmt/format.h>

#include "experiments/claim_names.h"
#include "experiments/commands.h"
#include "experiments/plan.h"
#include "experiments/verdicts.h"
#include "rows/results_file.h"

namespace podm::bench {

int verdicts(const std::vector<std::string>& experiment_paths, const std::string& results_folder,
             const std::string& json_path) {
  std::vector<Experiment> experiments;  // all, so that a bad file is refused before any verdict
  for (const std::string& path : experiment_paths) experiments.push_back(read_experiment(path));
  check_claim_names(experiments);
  std::vector<ExperimentVerdicts> all;
  for (const Experiment& experiment : experiments)
    all.push_back(judge(experiment, read_rows(rows_path(results_folder, experiment)).rows));
  fmt::print("{}", format_verdicts(all));
  if (!json_path.empty()) write_file(json_path, verdicts_as_json(all).dump(2) + "\n");
  return 0;
}

}  // namespace podm::bench
