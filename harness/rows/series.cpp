#include "rows/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "experiments/option_matrix.h"
#include "rows/machine_state.h"

namespace podm::bench {
namespace {

// Which statuses have a number that counts.
bool counts(const Row& row, const Measure& measure) {
  if (measure.meaning == Meaning::kOutcome) return true;
  return row.status == Status::kOk || (!varies(measure) && row.status == Status::kUnmet);
}

std::string fault_of(const Row& row) {
  return fmt::format("{}: {}: {}: {}", kRowsFailed, row.trial, to_string(row.status), row.reason);
}

// read() of each row, or why one has none. Rows of a round during which the machine's speed moved have no
// time.
Samples read_each(const RowPointers& rows, const Measure& measure, Value (*read)(const Row&)) {
  Samples samples;
  samples.num_rows = rows.size();
  for (const Row* row : rows) {
    if (measure.meaning == Meaning::kClock && probe_moved(*row)) continue;
    const Value value = counts(*row, measure) ? read(*row) : Value{{}, fault_of(*row)};
    if (!value.number) return {{}, {}, value.absence, rows.size()};
    samples.numbers.push_back(*value.number);
    samples.rounds.push_back(row->repeat);
  }
  if (samples.numbers.empty()) samples.absence = "the machine's speed moved during the round";
  return samples;
}

// The growth of read() over that of per() from the smallest size to the largest.
Samples sample_growth(const RowPointers& rows, const Measure& measure) {
  std::map<double, RowPointers> by_size;
  for (const Row* row : rows) by_size[row->asked.value(kTargetElements, 0.0)].push_back(row);
  if (by_size.size() < 2) return {{}, {}, "needs two target_elements, has one", rows.size()};
  double growth[2] = {0, 0};
  for (const bool is_largest : {false, true}) {
    const RowPointers& of_size = is_largest ? by_size.rbegin()->second : by_size.begin()->second;
    const Samples counts = read_each(of_size, measure, measure.read);
    const Samples pers = read_each(of_size, measure, measure.per);
    for (const Samples* samples : {&counts, &pers})
      if (!samples->absence.empty()) return {{}, {}, samples->absence, rows.size()};
    growth[0] += is_largest ? counts.middle() : -counts.middle();
    growth[1] += is_largest ? pers.middle() : -pers.middle();
  }
  if (growth[1] <= 0) return {{}, {}, "the larger mesh took no more work than the smaller", rows.size()};
  return {{growth[0] / growth[1]}, {1}, "", rows.size()};
}

bool are_positive(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number > 0; });
}

std::map<int, double> by_round(const Samples& samples) {
  std::map<int, double> numbers;
  for (std::size_t i = 0; i < samples.numbers.size(); ++i) numbers[samples.rounds[i]] = samples.numbers[i];
  return numbers;
}

// The ratios within rounds; none unless each round holds both once.
std::vector<double> paired_ratios(const Samples& above, const Samples& below) {
  const auto numerators = by_round(above), denominators = by_round(below);
  std::vector<double> ratios;
  if (numerators.size() != above.numbers.size() || denominators.size() != below.numbers.size() ||
      numerators.size() != denominators.size())
    return ratios;
  for (const auto& [round, number] : numerators) {
    const auto found = denominators.find(round);
    if (found == denominators.end()) return {};
    ratios.push_back(number / found->second);
  }
  return ratios;
}

}  // namespace

std::vector<RowGroup> group_rows(const RowPointers& rows,
                                 const std::function<bool(const std::string& key)>& is_free) {
  std::vector<RowGroup> groups;
  std::map<std::string, std::size_t> places;
  for (const Row* row : rows) {
    std::map<std::string, Json>
        agreed;  // sorted by key, so that the order in which a file gives them does not count
    const Json options = options_of(*row);
    for (const auto& [key, value] : options.items())
      if (!is_free(key)) agreed[key] = value;
    const auto [place, is_new] = places.emplace(Json(agreed).dump(), groups.size());
    if (is_new) groups.push_back({Json(agreed), {}});
    groups[place->second].rows.push_back(row);
  }
  return groups;
}

std::vector<std::string> labels_of(const std::vector<RowGroup>& groups) {
  std::vector<std::string> labels;
  for (const RowGroup& group : groups) {
    std::vector<std::string> parts;
    for (const auto& [key, value] : group.options.items())
      if (std::any_of(groups.begin(), groups.end(),
                      [&](const RowGroup& other) { return option(other.options, key) != value; }))
        parts.push_back(describe(key, value));
    labels.push_back(fmt::format("{}", fmt::join(parts, ", ")));
  }
  return labels;
}

Samples sample(const RowPointers& rows, const Measure& measure) {
  return measure.per != nullptr ? sample_growth(rows, measure) : read_each(rows, measure, measure.read);
}

SeriesRatio ratio_of(const Samples& above, const Samples& below) {
  const bool has_interval = above.numbers.size() > 1 && below.numbers.size() > 1;
  if (!are_positive(above.numbers) || !are_positive(below.numbers)) {
    const double numerator = above.middle(), denominator = below.middle();
    const double ratio = denominator != 0 ? numerator / denominator
                         : numerator == 0 ? 1
                                          : std::numeric_limits<double>::infinity();
    return {{ratio, ratio, ratio}, false};
  }
  if (const auto ratios = paired_ratios(above, below); !ratios.empty())
    return {ratio_of_medians(ratios, std::vector<double>(ratios.size(), 1.0), Sampling::kPaired),
            has_interval};
  return {ratio_of_medians(above.numbers, below.numbers, Sampling::kIndependent), has_interval};
}

}  // namespace podm::bench
