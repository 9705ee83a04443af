// Runs the turns of an experiment that are not measured yet, one after the other, and prints its results.
#pragma once

#include <string>

#include "experiments/commands.h"
#include "experiments/plan.h"
#include "experiments/round_probes.h"
#include "machine/machine.h"
#include "process/stopwatch.h"
#include "trials/counters.h"
#include "trials/preparation.h"
#include "trials/trial.h"
#include "trials/trial_key.h"

namespace podm::bench {

/// The data that all trials of a command share.
struct Session {
  Session(const RunCommand& given, const std::string& mesher_sha256, const Machine& machine,
          StopQuery is_interrupted);

  const RunCommand& command;
  StopQuery is_interrupted;  ///< true if Ctrl-C or a request to end has come
  ProgramRecords programs;
  EnvironmentRecord environment;
  Preparer preparer;
  TrialKeys keys;
  TrialRunner runner;
  CountersKeptReady counters;
  RoundProbes probes{probe_machine, seconds_matter()};
};

/// Returns true if every turn of the plan has a row of status ok or may be skipped. A promise that a peer
/// does not keep is a result, not a failure.
bool run_experiment(Session& session, const Experiment& experiment, Plan plan);

}  // namespace podm::bench
