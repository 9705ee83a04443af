// An experiment is a set of trials, as written in experiments/*.toml. The format is in experiments/README.md.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "experiments/claim.h"
#include "options/trial_settings.h"
#include "process/usable_processors.h"

namespace podm::bench {

struct Experiment {
  std::string name;                 ///< the file's name without .toml
  std::string title, claim, paper;  ///< `paper` may be empty
  Tier tier = Tier::kDefault;
  double expected_minutes = 0;
  std::vector<Trial> trials;              ///< the matrix, expanded, in the order of the file
  std::vector<Claim> claims;              ///< the expected results; at least one
  std::vector<WithdrawnClaim> withdrawn;  ///< its former claims

  /// Returns the number of turns of all trials, including warm-ups.
  std::size_t num_turns() const;
};

/// Throws InputError "file:line:column: fault" on anything that is not exactly the format. If there are
/// `images`, they replace all inputs, and each is an input of its own; they are relative to the working
/// folder. "all" stands for the number of processors.
Experiment read_experiment(const std::string& path, const std::vector<std::string>& images = {},
                           int processors = usable_processors());

/// Returns the sorted paths of the *.toml files in a folder. Throws InputError when the folder cannot be
/// read.
std::vector<std::string> experiment_files(const std::string& folder);

}  // namespace podm::bench
