// The turns of an experiment that are not measured yet, one after the other, and what is told at its end.
#pragma once

#include <string>

#include "experiments/commands.h"
#include "experiments/plan.h"
#include "experiments/round_probes.h"
#include "machine/machine.h"
#include "trials/counters.h"
#include "trials/preparation.h"
#include "trials/trial.h"
#include "trials/trial_key.h"

namespace podm::bench {

/// What all trials of a command have in common.
struct Session {
  Session(const RunCommand& given, const std::string& mesher_sha256, const Machine& machine,
          StopQuery is_interrupted);

  const RunCommand& command;
  StopQuery is_interrupted;  ///< whether Ctrl-C or a request to end has come
  ProgramRecords programs;
  EnvironmentRecord environment;
  Preparer preparer;
  TrialKeys keys;
  TrialRunner runner;
  CountersKeptReady counters;
  RoundProbes probes{probe_machine};
};

/// Whether every turn of the plan has a row of status ok, or may be skipped.
bool run_experiment(Session& session, const Experiment& experiment, Plan plan);

}  // namespace podm::bench
