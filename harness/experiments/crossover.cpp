#include "experiments/crossover.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "rows/machine_state.h"
#include "rows/row_filter.h"
#include "rows/series.h"

namespace podm::bench {
namespace {

constexpr const char* kSchema = "podm-crossover/2";

// Cells per second of the repeats.
struct Rates {
  Samples podm, podm_home;
};

// The trials of one [[trials]] on one image.
struct Series {
  const Row* row = nullptr;  // any of its rows
  double cells_per_thread = 0;
  std::map<int, Rates> by_threads;

  bool has_both() const {
    return std::any_of(by_threads.begin(), by_threads.end(), [](const auto& entry) {
      return !entry.second.podm.numbers.empty() && !entry.second.podm_home.numbers.empty();
    });
  }
};

bool is_measured(const Row& row) {
  return row.status == Status::kOk && !row.warmup && row.mesh &&
         row.asked.value("executor", "threads") == "threads" && !row.asked.contains("topology") &&
         !row.asked.contains("oversubscribe") && !probe_moved(row);
}

void add(const Row& row, std::map<std::string, Series>& all) {
  const std::string algorithm = row.asked.value("algorithm", "");
  if (!is_measured(row) || (algorithm != "podm" && algorithm != "podm-home")) return;
  const int threads = row.asked.value("threads", 1);
  const auto cells = static_cast<double>(row.mesh->cells);
  // A trial's name is its stem and the keys of its matrix. Among these keys only algorithm and threads matter
  // here.
  Series& series = all[stem_of(row.trial) + '\n' + row.input.name];
  series.row = &row;
  series.cells_per_thread = std::max(series.cells_per_thread, cells / threads);
  Rates& rates = series.by_threads[threads];
  Samples& samples = algorithm == "podm" ? rates.podm : rates.podm_home;
  samples.numbers.push_back(cells / meshing_seconds(row.mesh->phases_s));
  samples.rounds.push_back(row.repeat);
  samples.varies = true;
}

Crossover crossover_of(const Series& series) {
  const Row& row = *series.row;
  Crossover crossover{.schema = kSchema,
                      .threads = {},
                      .machine = row.environment,
                      .podm = row.programs.podm,
                      .experiment = row.experiment,
                      .trial = stem_of(row.trial),
                      .input = row.input.name,
                      .measurements = {}};
  bool is_ahead = true;
  for (auto entry = series.by_threads.rbegin(); entry != series.by_threads.rend(); ++entry) {
    const auto& [threads, rates] = *entry;
    if (rates.podm.numbers.empty() || rates.podm_home.numbers.empty()) continue;
    const Estimate ratio = ratio_of(rates.podm_home, rates.podm);
    is_ahead = is_ahead && ratio.interval->low > 1;
    if (is_ahead) crossover.threads = threads;
    crossover.measured_up_to = std::max(crossover.measured_up_to, threads);
    crossover.measurements.push_back({threads,
                                      rates.podm.middle(),
                                      rates.podm_home.middle(),
                                      ratio.value,
                                      {ratio.interval->low, ratio.interval->high},
                                      ratio.interval->coverage,
                                      {rates.podm.numbers.size(), rates.podm_home.numbers.size()}});
  }
  std::reverse(crossover.measurements.begin(), crossover.measurements.end());
  return crossover;
}

}  // namespace

std::optional<Crossover> crossover_of(const std::vector<std::vector<Row>>& rows_of_trials) {
  std::map<std::string, Series> all;
  for (const std::vector<Row>& rows : rows_of_trials)
    for (const Row& row : rows) add(row, all);
  const Series* largest = nullptr;
  for (const auto& [name, series] : all)
    if (series.has_both() && (largest == nullptr || series.cells_per_thread > largest->cells_per_thread))
      largest = &series;
  return largest == nullptr ? std::nullopt : std::optional(crossover_of(*largest));
}

std::string tell_crossover(const Crossover& crossover) {
  if (!crossover.threads)
    return fmt::format("podm-home overtook podm on no number of threads up to {} (trial {})",
                       crossover.measured_up_to, crossover.trial);
  return fmt::format("podm-home overtook podm from {} threads on (trial {})", *crossover.threads,
                     crossover.trial);
}

}  // namespace podm::bench
