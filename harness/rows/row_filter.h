// Selects the rows of an experiment that a claim is about, by the options of their trials.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rows/measure.h"
#include "rows/row.h"

namespace podm::bench {

/// The value of an option that the trial does not set.
inline constexpr const char* kNoOption = "none";

using RowPointers = std::vector<const Row*>;

/// The key of the image, beside the options of a trial.
inline constexpr const char* kInput = "input";

/// True if an option has one of the values, or if its number lies in the range.
struct Condition {
  std::string key;
  std::vector<Json> values;  ///< empty: the range decides
  std::optional<double> at_least, at_most;
};
/// All of these conditions must hold.
using Filter = std::vector<Condition>;

/// Returns the requested options, with defaults for `mesher` and `executor` if they are absent.
Json complete_options(Json asked);
/// Returns a row's completed options, with its image as kInput.
Json options_of(const Row& row);

/// Returns the value of an option; kNoOption if it is absent.
Json option(const Json& options, const std::string& key);

bool matches(const Json& options, const Condition& condition);
bool matches(const Json& options, const Filter& filter);
bool names(const Filter& filter, const std::string& key);

/// "threads=64, contention=local or global".
std::string describe(const Filter& filter);
std::string describe(const std::string& key, const Json& value);

bool is_simulated(const Row& row);
/// Returns the first value of a list that no row has; empty: each has rows.
std::string missing_value(const Filter& filter, const RowPointers& rows);

/// True if a claim of this basis is about the row.
bool is_of(const Row& row, Basis basis);

/// Returns a trial's name as in the experiment's file, without ",key=value".
std::string stem_of(const std::string& trial);

/// Returns the rows that may be judged, in their order: the last row of each trial, repeat and image, without
/// warm-ups and interrupted rows. Rows of a mesher count if its newest program made them. Measured rows count
/// if the machine of the newest measured row made them. Simulated rows count on any machine, and for one
/// described machine only rows of its newest version count.
std::vector<Row> rows_to_judge(const std::vector<Row>& rows);

/// Returns the measured rows that rows_to_judge() leaves out because another machine made them.
std::vector<Row> rows_of_other_machines(const std::vector<Row>& rows);

}  // namespace podm::bench
