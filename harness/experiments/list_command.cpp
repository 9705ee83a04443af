#include <fmt/format.h>

#include "experiments/claim_names.h"
#include "experiments/commands.h"

namespace podm::bench {

int list(const std::string& folder) {
  const std::vector<std::string> paths = experiment_files(folder);
  std::vector<Experiment> experiments;
  for (const std::string& path : paths) experiments.push_back(read_experiment(path));
  check_claim_names(experiments);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const Experiment& experiment = experiments[i];
    fmt::print("{}  {}  ({}, {} trials, {} runs, about {:g} minutes)\n", paths[i], experiment.title,
               to_string(experiment.tier), experiment.trials.size(), experiment.num_turns(),
               experiment.expected_minutes);
  }
  return 0;
}

}  // namespace podm::bench
