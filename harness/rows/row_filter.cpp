#include "rows/row_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "options/option_keys.h"
#include "rows/machine_state.h"

namespace podm::bench {
namespace {

constexpr const char *kExecutor = "executor", *kThreads = "threads";

std::string text_of(const Json& value) {
  return value.is_string()         ? value.get<std::string>()
         : value.is_number_float() ? fmt::format("{}", value.get<double>())
                                   : value.dump();
}

// Returns the program that made the row: this program, podm, podm on ranks or a peer.
std::string maker_of(const Row& row) {
  if (asked_of(row).contains(kRanks)) return kRanks;
  return asked_of(row).contains(kMeasure) ? kMeasure : asked_of(row).value(kMesher, kPodm);
}

// Returns the hash that rows of one maker share: that of the mesher, if a mesh is made.
std::string program_of(const Row& row) {
  const auto& [podm, verifier, peer, podm_mpi] = row.programs;
  const std::string maker = maker_of(row);
  return maker == kPodm                ? podm.sha256
         : maker == kRanks && podm_mpi ? podm_mpi->sha256
         : peer                        ? peer->sha256
                                       : "";
}

// Returns the described machine as the experiment's file names it; "" if there is none.
std::string described_machine_of(const Row& row) { return asked_of(row).value("topology", ""); }

const Row* newest_measured(const std::vector<Row>& rows) {
  const auto found = std::find_if_not(rows.rbegin(), rows.rend(), is_simulated);
  return found == rows.rend() ? nullptr : &*found;
}

bool is_of_another_machine(const Row& row, const Row* newest) {
  return !is_simulated(row) && !same_machine(row, *newest);
}

// The newest program of each maker and the newest model of each described machine, among the rows that may
// count.
class Newest {
 public:
  Newest(const std::vector<Row>& rows, const Row* newest_measured) {
    for (const Row& row : rows) {
      if (is_of_another_machine(row, newest_measured)) continue;
      programs_[maker_of(row)] = program_of(row);
      if (is_simulated(row)) models_[described_machine_of(row)] = model_of(row);
    }
  }
  bool made(const Row& row) const {
    return programs_.at(maker_of(row)) == program_of(row) &&
           (!is_simulated(row) || models_.at(described_machine_of(row)) == model_of(row));
  }

 private:
  std::map<std::string, std::string> programs_, models_;
};

// Identifies the turn of a row; a later row of the same turn replaces it. Keys of rows cannot do so: a trial
// that could not be prepared, or whose options or radius changed since, has another key.
std::tuple<std::string, int, std::string> turn_of(const Row& row) {
  return {row.trial, row.repeat, row.input.name};
}

}  // namespace

Json complete_options(Json asked) {
  if (!asked.is_object()) asked = Json::object();
  if (!asked.contains(kMesher)) asked[kMesher] = kPodm;
  if (!asked.contains(kExecutor)) asked[kExecutor] = kThreads;
  return asked;
}

Json options_of(const Row& row) {
  Json options = complete_options(asked_of(row));
  options[kInput] = row.input.name;
  return options;
}

Json option(const Json& options, const std::string& key) { return options.value(key, Json(kNoOption)); }

bool matches(const Json& options, const Condition& condition) {
  const Json found = option(options, condition.key);
  if (!condition.values.empty())
    return std::find(condition.values.begin(), condition.values.end(), found) != condition.values.end();
  if (!found.is_number()) return false;
  const double number = found;
  return number >= condition.at_least.value_or(number) && number <= condition.at_most.value_or(number);
}

bool matches(const Json& options, const Filter& filter) {
  return std::all_of(filter.begin(), filter.end(),
                     [&](const Condition& condition) { return matches(options, condition); });
}

bool names(const Filter& filter, const std::string& key) {
  return std::any_of(filter.begin(), filter.end(),
                     [&](const Condition& condition) { return condition.key == key; });
}

std::string describe(const std::string& key, const Json& value) {
  return fmt::format("{}={}", key, text_of(value));
}

std::string describe(const Filter& filter) {
  std::vector<std::string> parts;
  for (const Condition& condition : filter) {
    std::vector<std::string> values;
    for (const Json& value : condition.values) values.push_back(text_of(value));
    std::string part = fmt::format("{}={}", condition.key, fmt::join(values, " or "));
    if (condition.at_least) part = fmt::format("{}>={}", condition.key, *condition.at_least);
    if (condition.at_most)
      part += fmt::format("{}<={}", condition.at_least ? " and " : condition.key, *condition.at_most);
    parts.push_back(std::move(part));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string missing_value(const Filter& filter, const RowPointers& rows) {
  for (const Condition& condition : filter)
    for (const Json& value : condition.values) {
      const auto has = [&](const Row* row) { return option(options_of(*row), condition.key) == value; };
      if (std::none_of(rows.begin(), rows.end(), has)) return describe(condition.key, value);
    }
  return "";
}

bool is_simulated(const Row& row) { return row.basis == Basis::kSimulated; }

bool is_of(const Row& row, Basis basis) {
  return basis == Basis::kAny || is_simulated(row) == (basis == Basis::kSimulated);
}

std::string stem_of(const std::string& trial) { return trial.substr(0, trial.find(',')); }

std::vector<Row> rows_to_judge(const std::vector<Row>& rows) {
  std::vector<Row> chosen;
  const Row* const of_machine = newest_measured(rows);
  const Newest newest(rows, of_machine);
  std::map<std::tuple<std::string, int, std::string>, std::size_t> places;
  for (const Row& row : rows) {
    if (row.warmup || row.status == Status::kInterrupted) continue;
    if (is_of_another_machine(row, of_machine) || !newest.made(row)) continue;
    const auto [place, is_new] = places.emplace(turn_of(row), chosen.size());
    if (is_new)
      chosen.push_back(row);
    else
      chosen[place->second] = row;
  }
  return chosen;
}

std::vector<Row> rows_of_other_machines(const std::vector<Row>& rows) {
  const Row* const of_machine = newest_measured(rows);
  std::vector<Row> others;
  for (const Row& row : rows)
    if (is_of_another_machine(row, of_machine)) others.push_back(row);
  return others;
}

}  // namespace podm::bench
