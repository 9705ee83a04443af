// What a trial will probably take, from what it took before.
#pragma once

#include <optional>
#include <vector>

#include "experiments/experiment.h"
#include "rows/row.h"

namespace podm::bench {

/// Members are empty where nothing is known.
struct Expectation {
  std::optional<double> seconds;                   ///< one turn takes them, verification included
  std::optional<double> memory_bytes, disk_bytes;  ///< without rows, only what elements aimed at take
};

class Expectations {
 public:
  Expectations(const Experiment& experiment, std::vector<Row> rows);

  /// The finished rows of the trial on the same image tell it; without any, the trial has its share of the
  /// experiment's minutes by the elements aimed at.
  Expectation of(const Trial& trial) const;

 private:
  std::optional<double> seconds_per_weight_;  // the experiment's minutes tell it
  std::vector<Row> rows_;
};

}  // namespace podm::bench
