#include "experiments/crossover.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "rows/record.h"
#include "rows/statistics.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "podm-crossover/1";

// Cells a second of the repeats.
struct Rates {
  std::vector<double> podm, pdr_podm;
};

// The trials of one [[trials]] on one image.
struct Series {
  const Json* row = nullptr;  // any
  double cells_per_thread = 0;
  std::map<int, Rates> by_threads;

  bool has_both() const {
    return std::any_of(by_threads.begin(), by_threads.end(), [](const auto& entry) {
      return !entry.second.podm.empty() && !entry.second.pdr_podm.empty();
    });
  }
};

bool is_measured(const Json& row, const Json& asked) {
  return text_in(row, "status") == to_string(Status::kOk) && !row.value("warmup", false) &&
         asked.value("executor", "threads") == "threads" && !asked.contains("topology") &&
         !asked.contains("oversubscribe");
}

void add(const Json& row, std::map<std::string, Series>& all) {
  const Json asked = row.value("asked", Json::object());
  const std::string algorithm = asked.value("algorithm", ""), trial = text_in(row, "trial");
  if (!is_measured(row, asked) || (algorithm != "podm" && algorithm != "pdr-podm")) return;
  const int threads = asked.value("threads", 1);
  const double cells = row["cells"];
  // Keys of a matrix follow the name; those that matter here are algorithm and threads.
  Series& series = all[trial.substr(0, trial.find(',')) + '\n' + text_in(row["input"], "name")];
  series.row = &row;
  series.cells_per_thread = std::max(series.cells_per_thread, cells / threads);
  Rates& rates = series.by_threads[threads];
  (algorithm == "podm" ? rates.podm : rates.pdr_podm).push_back(cells / meshing_seconds(row));
}

Json crossover_of(const Series& series) {
  Json threshold, measurements = Json::array();
  bool is_ahead = true;
  int most = 0;
  for (auto entry = series.by_threads.rbegin(); entry != series.by_threads.rend(); ++entry) {
    const auto& [threads, rates] = *entry;
    if (rates.podm.empty() || rates.pdr_podm.empty()) continue;
    const Ratio ratio = ratio_of_medians(rates.pdr_podm, rates.podm, Sampling::kIndependent);
    is_ahead = is_ahead && ratio.low > 1;
    if (is_ahead) threshold = threads;
    most = std::max(most, threads);
    measurements.push_back({{"threads", threads},
                            {"podm_cells_per_second", median(rates.podm)},
                            {"pdr_podm_cells_per_second", median(rates.pdr_podm)},
                            {"ratio", ratio.value},
                            {"ratio_interval", {ratio.low, ratio.high}},
                            {"rows", {rates.podm.size(), rates.pdr_podm.size()}}});
  }
  std::reverse(measurements.begin(), measurements.end());
  const Json& row = *series.row;
  return {{"schema", kSchema},
          {"threads", threshold},
          {"measured_up_to", most},
          {"machine", machine_of(row)},
          {"podm", row.value(Json::json_pointer("/programs/podm"), Json())},
          {"experiment", text_in(row, "experiment")},
          {"trial", text_in(row, "trial").substr(0, text_in(row, "trial").find(','))},
          {"input", text_in(row["input"], "name")},
          {"measurements", measurements}};
}

}  // namespace

Json crossover_of(const std::vector<std::vector<Json>>& rows_of_trials) {
  std::map<std::string, Series> all;
  for (const std::vector<Json>& rows : rows_of_trials)
    for (const Json& row : rows) add(row, all);
  const Series* largest = nullptr;
  for (const auto& [name, series] : all)
    if (series.has_both() && (largest == nullptr || series.cells_per_thread > largest->cells_per_thread))
      largest = &series;
  return largest == nullptr ? Json() : crossover_of(*largest);
}

std::string tell_crossover(const Json& crossover) {
  if (crossover["threads"].is_null())
    return fmt::format("pdr-podm overtook podm on no number of threads up to {} (trial {})",
                       crossover["measured_up_to"].get<int>(), text_in(crossover, "trial"));
  return fmt::format("pdr-podm overtook podm from {} threads on (trial {})", crossover["threads"].get<int>(),
                     text_in(crossover, "trial"));
}

}  // namespace podm::bench
