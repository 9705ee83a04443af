// Which rows of an experiment a claim is about: by the options that their trials ask for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rows/measure.h"
#include "rows/row.h"

namespace podm::bench {

/// The value that stands for an option which the trial does not give.
inline constexpr const char* kNoOption = "none";

using RowPointers = std::vector<const Row*>;

/// The image, beside the options that a trial asks for.
inline constexpr const char* kInput = "input";

/// An option has one of the values, or its number lies in the range.
struct Condition {
  std::string key;
  std::vector<Json> values;  ///< empty: the range decides
  std::optional<double> at_least, at_most;
};
/// All of these conditions hold.
using Filter = std::vector<Condition>;

/// Options as asked for, with `mesher` and `executor` where they are left to their defaults.
Json complete_options(Json asked);
/// A row's options, completed, and its image as kInput.
Json options_of(const Row& row);

/// A value of an option, kNoOption where the options do not have it.
Json option(const Json& options, const std::string& key);

bool matches(const Json& options, const Condition& condition);
bool matches(const Json& options, const Filter& filter);
bool names(const Filter& filter, const std::string& key);

/// "threads=64, contention=local or global".
std::string describe(const Filter& filter);
std::string describe(const std::string& key, const Json& value);

bool is_simulated(const Row& row);
/// The first value of a list that no row has; empty: each has rows.
std::string missing_value(const Filter& filter, const RowPointers& rows);

/// Whether a claim of this basis is about the row.
bool is_of(const Row& row, Basis basis);

/// A trial's name as the experiment's file has it, without ",key=value".
std::string stem_of(const std::string& trial);

/// The rows that may be judged, in their order: those of the newest row's mesher, of each trial, repeat and
/// image the last, without warm-ups and what the user interrupted. Measured rows are those of the newest
/// one's machine; simulated rows count wherever they were made, but of one described machine in its newest
/// version.
std::vector<Row> rows_to_judge(const std::vector<Row>& rows);

/// Measured rows that rows_to_judge() leaves out as another machine made them.
std::vector<Row> rows_of_other_machines(const std::vector<Row>& rows);

}  // namespace podm::bench
