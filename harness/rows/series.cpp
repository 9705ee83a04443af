#include "rows/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "options/option_keys.h"
#include "rows/machine_state.h"

namespace podm::bench {
namespace {

// True if a row of this status has a number that counts.
bool counts(const Row& row, const Measure& measure) {
  if (measure.meaning == Meaning::kOutcome) return true;
  return row.status == Status::kOk || (!varies(measure) && row.status == Status::kUnmet);
}

std::string fault_of(const Row& row) {
  return fmt::format("{}: {}: {}: {}", kRowsFailed, row.trial, to_string(row.status), row.reason);
}

Samples absent(const std::string& why, const RowPointers& rows) {
  Samples samples;
  samples.absence = why;
  samples.num_rows = rows.size();
  return samples;
}

// Reads read() from each row, or returns the reason why a row has no number.
Samples read_each(const RowPointers& rows, const Measure& measure, Value (*read)(const Row&)) {
  Samples samples;
  samples.num_rows = rows.size();
  for (const Row* row : rows) {
    const Value value = counts(*row, measure) ? read(*row) : Value{{}, fault_of(*row)};
    if (!value.number) return absent(value.absence, rows);
    samples.numbers.push_back(*value.number);
    samples.rounds.push_back(row->repeat);
    samples.varies = samples.varies || varies_between_runs(measure, *row);
    if (is_disturbed(*row)) samples.busy = std::max(samples.busy, busy_elsewhere(*row));
  }
  return samples;
}

std::map<int, double> by_round(const Samples& samples) {
  std::map<int, double> numbers;
  for (std::size_t i = 0; i < samples.numbers.size(); ++i) numbers[samples.rounds[i]] = samples.numbers[i];
  return numbers;
}

// Returns the growth of read() over that of per() from the smallest size to the largest, for each round that
// has both.
Samples sample_growth(const RowPointers& rows, const Measure& measure) {
  std::map<double, RowPointers> by_size;
  for (const Row* row : rows) by_size[asked_of(*row).value(kTargetElements, 0.0)].push_back(row);
  if (by_size.size() < 2) return absent("needs two target_elements, has one", rows);
  const RowPointers &smallest = by_size.begin()->second, &largest = by_size.rbegin()->second;
  const Samples counts[2] = {read_each(smallest, measure, measure.read),
                             read_each(largest, measure, measure.read)};
  const Samples pers[2] = {read_each(smallest, measure, measure.per),
                           read_each(largest, measure, measure.per)};
  for (const Samples* samples : {&counts[0], &counts[1], &pers[0], &pers[1]})
    if (!samples->absence.empty()) return absent(samples->absence, rows);
  Samples growth;
  growth.num_rows = rows.size();
  growth.varies = counts[0].varies || counts[1].varies;
  growth.busy = std::max(counts[0].busy, counts[1].busy);
  auto small_counts = by_round(counts[0]), small_pers = by_round(pers[0]), large_pers = by_round(pers[1]);
  for (const auto& [round, count] : by_round(counts[1])) {
    if (!small_counts.contains(round)) continue;
    const double further = large_pers[round] - small_pers[round];
    if (further <= 0) return absent("the larger mesh took no more work than the smaller", rows);
    growth.numbers.push_back((count - small_counts[round]) / further);
    growth.rounds.push_back(round);
  }
  return growth.numbers.empty() ? absent("no round has both target_elements", rows) : growth;
}

// Returns the ratios within the rounds that hold both; none if a series has several numbers in one round.
std::vector<double> paired_ratios(const Samples& above, const Samples& below) {
  const auto numerators = by_round(above), denominators = by_round(below);
  std::vector<double> ratios;
  if (numerators.size() != above.numbers.size() || denominators.size() != below.numbers.size()) return ratios;
  for (const auto& [round, number] : numerators)
    if (const auto found = denominators.find(round); found != denominators.end())
      ratios.push_back(ratio_of_numbers(number, found->second));
  return ratios;
}

}  // namespace

std::vector<RowGroup> group_rows(const RowPointers& rows,
                                 const std::function<bool(const std::string& key)>& is_free) {
  std::vector<RowGroup> groups;
  std::map<std::string, std::size_t> places;
  for (const Row* row : rows) {
    std::map<std::string, Json> agreed;  // sorted by key; the order in a file does not count
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
    for (const auto& item : group.options.items())
      if (std::any_of(groups.begin(), groups.end(), [&](const RowGroup& other) {
            return option(other.options, item.key()) != item.value();
          }))
        parts.push_back(describe(item.key(), item.value()));
    labels.push_back(fmt::format("{}", fmt::join(parts, ", ")));
  }
  return labels;
}

Samples sample(const RowPointers& rows, const Measure& measure) {
  RowPointers steady;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(steady),
               [&](const Row* row) { return !probe_moved(*row) || !varies_between_runs(measure, *row); });
  if (steady.empty()) return absent("the machine's speed moved during each round", rows);
  return measure.per != nullptr ? sample_growth(steady, measure) : read_each(steady, measure, measure.read);
}

Estimate estimate_of(const Samples& samples) {
  Estimate estimate{
      samples.middle(), {}, samples.numbers, samples.numbers.size(), samples.varies ? samples.busy : 0};
  if (samples.varies) estimate.interval = median_interval(samples.numbers);
  return estimate;
}

Estimate ratio_of(const Samples& above, const Samples& below) {
  Samples ratios;
  ratios.numbers = paired_ratios(above, below);
  ratios.varies = above.varies || below.varies;
  ratios.busy = std::max(above.varies ? above.busy : 0, below.varies ? below.busy : 0);
  if (!ratios.numbers.empty()) return estimate_of(ratios);
  Estimate estimate{ratio_of_numbers(above.middle(), below.middle()), {}, {}, 0, ratios.busy};
  estimate.num_rounds = std::min(above.numbers.size(), below.numbers.size());
  if (ratios.varies) estimate.interval = ratio_interval(above.numbers, below.numbers);
  return estimate;
}

}  // namespace podm::bench
