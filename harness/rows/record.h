// The JSON line that a trial leaves behind: the mesher's own record, and around it what the harness saw.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "experiments/schedule.h"
#include "trials/trial.h"

namespace podm::bench {

inline constexpr int kRowSchema = 4;  ///< results/schema/podm-bench-row.schema.json

/// Of a row that measures the machine in place of a mesh: a list, Table 3.
inline constexpr const char* kMemoryLevels = "memory_levels";

/// What a row tells beside the trial and its result.
struct RowContext {
  std::string experiment;              ///< its name
  std::string key;                     ///< of the turn, TrialKeys
  std::uint64_t order_seed = 0;        ///< of the schedule
  double harness_s = 0;                ///< spent by this program since the row before
  nlohmann::ordered_json programs;     ///< describe_programs()
  nlohmann::ordered_json environment;  ///< before the trial
};

/// What a row with these options and counters is: "simulated" in virtual time, on a described machine or on
/// cachegrind's core, else "measured".
std::string basis_of(const nlohmann::ordered_json& asked, const nlohmann::ordered_json& counters);

/// Peak resident bytes a cell beyond labels and feature transform of the image; nothing without a mesh.
std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result);

/// The row of a trial that ran, whatever came of it.
nlohmann::ordered_json make_row(const RowContext& context, const Trial& trial, const Turn& turn,
                                const TrialResult& result);

/// The text at `key` of a row; empty when there is none.
std::string text_in(const nlohmann::ordered_json& row, const char* key);
/// The number at `key`; nothing when there is none.
std::optional<double> number_in(const nlohmann::ordered_json& row, const char* key);

/// What is at a place of a row, "/process/counters"; null when there is nothing.
nlohmann::ordered_json at(const nlohmann::ordered_json& row, const std::string& place);
/// The number at a place; nothing when there is none.
std::optional<double> number_at(const nlohmann::ordered_json& row, const char* place);
/// The sum of the members of the object or list at a place; nothing when there is none.
std::optional<double> sum_at(const nlohmann::ordered_json& row, const char* place);

/// Processor and numbers of packages, nodes, cores and processors of the row's machine, as far as it tells.
nlohmann::ordered_json machine_of(const nlohmann::ordered_json& row);

/// Whether a row holds a mesh that met its guarantees or is known not to: "ok" or "unmet".
bool is_finished(const nlohmann::ordered_json& row);

}  // namespace podm::bench
