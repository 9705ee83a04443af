// An experiment: which trials to run, as written in experiments/*.toml. The format is in
// experiments/README.md.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "experiments/claim.h"
#include "options/trial_settings.h"

namespace podm::bench {

struct Experiment {
  std::string name;                 ///< the file's name without .toml
  std::string title, claim, paper;  ///< the last may be empty
  Tier tier = Tier::kDefault;
  double expected_minutes = 0;
  std::vector<Trial> trials;              ///< the matrix, expanded, in the order of the file
  std::vector<Claim> claims;              ///< what its rows are to show; at least one
  std::vector<WithdrawnClaim> withdrawn;  ///< what it claimed once

  /// Times that a mesh is made, warm-ups included.
  std::size_t num_turns() const;
};

/// Throws InputError "file:line:column: fault" on anything that is not exactly the format. `images`, where
/// there are some, stand for all inputs, each an input of its own; they are relative to the working folder.
Experiment read_experiment(const std::string& path, const std::vector<std::string>& images = {});

/// Paths of the *.toml of a folder, sorted. Throws InputError when it cannot be read.
std::vector<std::string> experiment_files(const std::string& folder);

}  // namespace podm::bench
