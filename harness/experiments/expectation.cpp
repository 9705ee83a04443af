#include "experiments/expectation.h"

#include "options/option_keys.h"
#include "rows/order_statistics.h"
#include "rows/table.h"

namespace podm::bench {
namespace {

// Meshes of a million cells took 130 to 153 bytes of memory per cell beyond the image (results/reference),
// and a VTU file.
constexpr double kMemoryBytesPerCell = 160, kDiskBytesPerCell = 50;

// The cost of a turn besides its cells, in cells; and the assumed number of cells if the file sets the
// radius.
constexpr double kPreparationInCells = 200'000, kUnknownCells = 1'000'000;

double weight_of(const Trial& trial) {
  return kPreparationInCells + trial.options.value(kTargetElements, kUnknownCells);
}

void keep_largest(std::optional<double>& largest, const std::optional<double>& value) {
  if (value && (!largest || *value > *largest)) largest = value;
}

bool is_of(const Row& row, const Trial& trial) {
  return row.trial == trial.name && is_finished(row) && row.input.name == trial.image;
}

}  // namespace

Expectations::Expectations(const Experiment& experiment, std::vector<Row> rows) : rows_(std::move(rows)) {
  double weight = 0;
  for (const Trial& trial : experiment.trials) weight += weight_of(trial) * (trial.repeats + trial.warmups);
  if (experiment.expected_minutes > 0) seconds_per_weight_ = 60 * experiment.expected_minutes / weight;
}

Expectation Expectations::of(const Trial& trial) const {
  Expectation expected;
  std::vector<double> seconds;
  for (const Row& row : rows_) {
    if (!is_of(row, trial)) continue;
    seconds.push_back(row.process.wall_s + row.preparation_s + row.verification_s);
    keep_largest(expected.memory_bytes, static_cast<double>(row.process.peak_rss_bytes));
    keep_largest(expected.disk_bytes, row.mesh_bytes);
  }
  if (seconds_per_weight_) expected.seconds = *seconds_per_weight_ * weight_of(trial);
  if (!seconds.empty()) expected.seconds = median(seconds);
  if (trial.options.contains(kTargetElements)) {
    const double elements = trial.options[kTargetElements];
    if (!expected.memory_bytes) expected.memory_bytes = elements * kMemoryBytesPerCell;
    if (!expected.disk_bytes) expected.disk_bytes = elements * kDiskBytesPerCell;
  }
  return expected;
}

}  // namespace podm::bench
