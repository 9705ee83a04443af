#include "experiments/expectation.h"

#include <algorithm>

#include "rows/record.h"
#include "rows/statistics.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

// Of meshes of a million cells: 130 to 153 bytes of memory beyond the image (results/reference), and a VTU
// file.
constexpr double kMemoryBytesPerCell = 160, kDiskBytesPerCell = 50;

// What a turn takes beside its cells, as cells; cells where the file sets the radius.
constexpr double kPreparationInCells = 200'000, kUnknownCells = 1'000'000;

double weight_of(const Trial& trial) {
  return kPreparationInCells + number_in(trial.options, "target_elements").value_or(kUnknownCells);
}

void keep_largest(std::optional<double>& largest, const std::optional<double>& value) {
  if (value && (!largest || *value > *largest)) largest = value;
}

bool is_of(const Json& row, const Trial& trial) {
  return text_in(row, "trial") == trial.name && is_finished(row) &&
         text_in(row.value("input", Json::object()), "name") == trial.image;
}

}  // namespace

Expectations::Expectations(const Experiment& experiment, std::vector<Json> rows) : rows_(std::move(rows)) {
  double weight = 0;
  for (const Trial& trial : experiment.trials) weight += weight_of(trial) * (trial.repeats + trial.warmups);
  if (experiment.expected_minutes > 0) seconds_per_weight_ = 60 * experiment.expected_minutes / weight;
}

Expectation Expectations::of(const Trial& trial) const {
  Expectation expected;
  std::vector<double> seconds;
  for (const Json& row : rows_) {
    if (!is_of(row, trial)) continue;
    const Json process = row.value("process", Json::object());
    if (const auto wall_s = number_in(process, "wall_s"))
      seconds.push_back(*wall_s + number_in(row, "preparation_s").value_or(0) +
                        number_in(row, "verification_s").value_or(0));
    keep_largest(expected.memory_bytes, number_in(process, "peak_rss_bytes"));
    keep_largest(expected.disk_bytes, number_in(row, "mesh_bytes"));
  }
  if (seconds_per_weight_) expected.seconds = *seconds_per_weight_ * weight_of(trial);
  if (!seconds.empty()) expected.seconds = median(seconds);
  if (const auto elements = number_in(trial.options, "target_elements")) {
    if (!expected.memory_bytes) expected.memory_bytes = *elements * kMemoryBytesPerCell;
    if (!expected.disk_bytes) expected.disk_bytes = *elements * kDiskBytesPerCell;
  }
  return expected;
}

}  // namespace podm::bench
