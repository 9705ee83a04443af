// Which turns of an experiment a command asks for, and which of them are measured already.
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
  std::string key;         ///< empty while the trial's radius is not found or its phantom not drawn
  std::optional<Row> row;  ///< an earlier run left it; the turn need not run again
};

/// The newest finished row of each key.
using FinishedRows = std::map<std::string, Row>;

struct Plan {
  std::vector<Trial> trials;          ///< those chosen
  std::vector<Expectation> expected;  ///< one a trial
  std::vector<PlannedTurn> turns;     ///< those of all trials, in their order
  FinishedRows finished;              ///< that need not run again

  std::size_t num_present() const;
};

/// All experiments of the command, read before anything runs.
std::vector<Experiment> read_experiments(const RunCommand& command);

std::string rows_path(const std::string& results_folder, const Experiment& experiment);

/// `rows` are those recorded for the experiment before.
Plan make_plan(const RunCommand& command, const Experiment& experiment, const std::vector<Row>& rows,
               Preparer& preparer, TrialKeys& keys);

}  // namespace podm::bench
