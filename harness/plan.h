// Which turns of an experiment a command asks for, and which of them are measured already.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "expectation.h"
#include "results_file.h"
#include "trial_key.h"

namespace podm::bench {

struct PlannedTurn {
  Turn turn;
  std::string key;
  std::optional<nlohmann::ordered_json> row;  ///< of an earlier run; it need not run again
};

struct Plan {
  std::vector<Trial> trials;          ///< as chosen
  std::vector<Expectation> expected;  ///< of each trial
  std::vector<PlannedTurn> turns;     ///< in their order

  std::size_t num_present() const;
};

/// All experiments of the command, read before anything runs.
std::vector<Experiment> read_experiments(const RunCommand& command);

std::string rows_path(const RunCommand& command, const Experiment& experiment);

/// `rows` are those recorded for the experiment before.
Plan make_plan(const RunCommand& command, const Experiment& experiment,
               const std::vector<nlohmann::ordered_json>& rows, TrialKeys& keys);

}  // namespace podm::bench
