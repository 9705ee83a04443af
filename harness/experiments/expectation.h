// Predicts the cost of a trial from its earlier runs.
#pragma once

#include <optional>
#include <vector>

#include "experiments/experiment.h"
#include "rows/row.h"

namespace podm::bench {

/// A member without a prediction is unset.
struct Expectation {
  std::optional<double> seconds;                   ///< per turn, including verification
  std::optional<double> memory_bytes, disk_bytes;  ///< without rows, set only for a target number of cells
};

class Expectations {
 public:
  Expectations(const Experiment& experiment, std::vector<Row> rows);

  /// Predicts from the finished rows of the trial on the same image. Without rows the time is the trial's
  /// share of the experiment's minutes, by its target number of cells.
  Expectation of(const Trial& trial) const;

 private:
  std::optional<double> seconds_per_weight_;  // from the experiment's minutes
  std::vector<Row> rows_;
};

}  // namespace podm::bench
