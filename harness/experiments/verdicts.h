// The claims of experiments and what their rows say of them, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/judge.h"
#include "rows/machine_state.h"

namespace podm::bench {

struct ExperimentVerdicts {
  const Experiment* experiment = nullptr;
  std::vector<Judgement> judgements;  ///< one a claim, in their order
  MachineState machine;               ///< while the rows that may be judged were measured
  std::string left_out;               ///< which rows of other machines; "" for none
};

/// `rows` are all there are of the experiment; those that may be judged are chosen here.
ExperimentVerdicts judge(const Experiment& experiment, const std::vector<Row>& rows);

/// A table, then what is known of the claims that do not hold, then their numbers.
std::string format_verdicts(const std::vector<ExperimentVerdicts>& all);

/// The format is told in results/README.md.
Json verdicts_as_json(const std::vector<ExperimentVerdicts>& all);

}  // namespace podm::bench
