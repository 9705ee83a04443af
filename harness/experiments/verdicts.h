// The claims of experiments and their verdicts, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/judge.h"
#include "rows/machine_state.h"

namespace podm::bench {

struct ExperimentVerdicts {
  const Experiment* experiment = nullptr;
  std::vector<Judgement> judgements;  ///< one per claim, in the order of the claims
  MachineState machine;               ///< during the measurement of the rows that may be judged
  std::string left_out;               ///< describes omitted rows of other machines; "" for none
};

/// `rows` are all rows of the experiment; this function selects those that may be judged.
ExperimentVerdicts judge(const Experiment& experiment, const std::vector<Row>& rows);

/// A table, then the known reasons of claims that do not hold, then the numbers of verdicts.
std::string format_verdicts(const std::vector<ExperimentVerdicts>& all);

/// results/README.md describes the format.
Json verdicts_as_json(const std::vector<ExperimentVerdicts>& all);

}  // namespace podm::bench
