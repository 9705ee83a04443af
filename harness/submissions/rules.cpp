#include "submissions/rules.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <set>

#include "rows/machine_state.h"

namespace podm::bench {

ExperimentsOn experiments_in(const std::string& folder) {
  const auto known = std::make_shared<std::map<int, std::vector<Experiment>>>();
  return [folder, known](int processors) -> const std::vector<Experiment>& {
    const auto [entry, is_new] = known->try_emplace(processors);
    if (is_new)
      for (const std::string& path : experiment_files(folder))
        entry->second.push_back(read_experiment(path, {}, processors));
    return entry->second;
  };
}

void check_rules(const Submission& submission, const ExperimentsOn& experiments, Faults& faults) {
  check_keys(submission, faults);
  check_programs(submission, faults);
  check_status(submission, faults);
  check_hashes_of_rows(submission, faults);
  check_machines(submission, faults);
  check_clock(submission, faults);
  check_logs(submission, faults);
  check_division(submission, experiments, faults);
  if (submission.rows.empty()) faults.push_back({"schema", "there is no row"});
}

std::string describe(const Submission& submission) {
  std::set<std::string> experiments, machines;
  for (const auto& [row, line, logs] : submission.rows) {
    experiments.insert(row.experiment);
    machines.insert(machine_name(row));
  }
  const auto counted = [](std::size_t number, const char* what) {
    return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
  };
  return fmt::format("{} division, {} of {} on {}", to_string(submission.manifest.division),
                     counted(submission.rows.size(), "row"), counted(experiments.size(), "experiment"),
                     counted(machines.size(), "machine"));
}

std::string describe(const Faults& faults) {
  constexpr int kMostPerRule = 5;
  std::map<std::string, int> counts;
  std::string text;
  for (const Fault& fault : faults)
    if (++counts[fault.rule] <= kMostPerRule) text += fmt::format("{}: {}\n", fault.rule, fault.text);
  for (const auto& [rule, count] : counts)
    if (count > kMostPerRule) text += fmt::format("{}: {} more\n", rule, count - kMostPerRule);
  return text;
}

}  // namespace podm::bench
