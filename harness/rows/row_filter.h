// Which rows of an experiment a claim is about: by the options that their trials ask for.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rows/measure.h"

namespace podm::bench {

/// The value that stands for an option which the trial does not give.
inline constexpr const char* kNoOption = "none";

using RowPointers = std::vector<const nlohmann::ordered_json*>;

/// The image, beside the options that a trial asks for.
inline constexpr const char* kInput = "input";

/// Of one option: one of the values, or a number in the range.
struct Condition {
  std::string key;
  std::vector<nlohmann::ordered_json> values;  ///< empty: the range decides
  std::optional<double> at_least, at_most;
};
/// All of them hold.
using Filter = std::vector<Condition>;

/// Options as asked for, with `mesher` and `executor` where they are left to their defaults.
nlohmann::ordered_json complete_options(nlohmann::ordered_json asked);
/// The same of a row, and kInput.
nlohmann::ordered_json options_of(const nlohmann::ordered_json& row);

/// A value of an option, kNoOption where the options do not have it.
nlohmann::ordered_json option(const nlohmann::ordered_json& options, const std::string& key);

bool matches(const nlohmann::ordered_json& options, const Condition& condition);
bool matches(const nlohmann::ordered_json& options, const Filter& filter);
bool names(const Filter& filter, const std::string& key);

/// "threads=64, contention=local or global".
std::string describe(const Filter& filter);
std::string describe(const std::string& key, const nlohmann::ordered_json& value);

bool is_simulated(const nlohmann::ordered_json& row);
/// The first value of a list that no row has; empty: each has rows.
std::string missing_value(const Filter& filter, const RowPointers& rows);

/// Whether a claim of this basis is about the row.
bool is_of(const nlohmann::ordered_json& row, Basis basis);

/// A trial's name as the experiment's file has it, without ",key=value".
std::string stem_of(const std::string& trial);

/// The rows that may be judged, in their order: those of the newest row's machine and mesher, of each trial,
/// repeat and image the last, without warm-ups and what the user interrupted.
std::vector<nlohmann::ordered_json> rows_to_judge(const std::vector<nlohmann::ordered_json>& rows);

}  // namespace podm::bench
