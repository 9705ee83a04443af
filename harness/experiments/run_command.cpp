#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "experiments/commands.h"
#include "experiments/experiment_run.h"
#include "experiments/plan.h"
#include "machine/machine.h"
#include "process/sha256.h"
#include "process/stop_request.h"
#include "rows/results_file.h"

namespace podm::bench {
namespace {

std::vector<Row> recorded_rows(const std::string& path) {
  const RowsRead read = repair_rows(path);
  if (read.broken_line > 0)
    fmt::print(stderr, "{}:{}: a broken line, left by a crash, is now in {}.broken; the other rows count\n",
               path, read.broken_line, path);
  return read.rows;
}

}  // namespace

int run(const RunCommand& command) {
  const std::vector<Experiment> experiments = read_experiments(command);
  const std::string mesher_sha256 = sha256_of_file(command.programs.podm);  // throws before a folder is made
  const ResultsLock lock(command.results_folder);
  const StopQuery is_interrupted = stop_on_signals();
  Session session(command, mesher_sha256, this_machine(), is_interrupted);
  std::vector<Plan> plans;  // all plans, so that a bad file is refused before anything runs
  for (const Experiment& experiment : experiments)
    plans.push_back(make_plan(command, experiment,
                              recorded_rows(rows_path(command.results_folder, experiment)), session.preparer,
                              session.keys));
  bool all_well = true;
  for (std::size_t i = 0; i < experiments.size() && !is_interrupted(); ++i)
    if (!plans[i].turns.empty())
      all_well = run_experiment(session, experiments[i], std::move(plans[i])) && all_well;
  return all_well && !is_interrupted() ? 0 : kExitMissed;
}

}  // namespace podm::bench
