// Selects the turns of an experiment that a command requests, and the turns that are measured already.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/commands.h"
#include "experiments/expectation.h"
#include "rows/results_file.h"
#include "trials/trial_key.h"

namespace podm::bench {

struct PlannedTurn {
  Turn turn;
  std::string key;         ///< empty until the trial's radius is found and its phantom drawn
  std::optional<Row> row;  ///< from an earlier run; the turn need not run again
};

/// The newest finished row of each key.
using FinishedRows = std::map<std::string, Row>;

struct Plan {
  std::vector<Trial> trials;          ///< the selected trials
  std::vector<Expectation> expected;  ///< one per trial
  std::vector<PlannedTurn> turns;     ///< of all trials, in their order
  FinishedRows finished;              ///< these need not run again

  std::size_t num_present() const;
};

/// Reads all experiments of the command before anything runs.
std::vector<Experiment> read_experiments(const RunCommand& command);

std::string rows_path(const std::string& results_folder, const Experiment& experiment);

/// `rows` are the recorded rows of the experiment.
Plan make_plan(const RunCommand& command, const Experiment& experiment, const std::vector<Row>& rows,
               Preparer& preparer, TrialKeys& keys);

}  // namespace podm::bench
