#include <fmt/format.h>

#include "commands.h"

namespace podm::bench {

int list(const std::string& folder) {
  for (const std::string& path : experiment_files(folder)) {
    const Experiment experiment = read_experiment(path);
    fmt::print("{}  {}  ({}, {} trials, {} runs, about {:g} minutes)\n", path, experiment.title,
               to_string(experiment.tier), experiment.trials.size(), experiment.num_turns(),
               experiment.expected_minutes);
  }
  return 0;
}

}  // namespace podm::bench
