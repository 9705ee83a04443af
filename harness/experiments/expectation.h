// What a trial will probably take, from what it took before.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "experiments/experiment.h"

namespace podm::bench {

/// Nothing where nothing is known.
struct Expectation {
  std::optional<double> seconds;                   ///< of one turn, verification included
  std::optional<double> memory_bytes, disk_bytes;  ///< from elements aimed at: beyond the image
};

class Expectations {
 public:
  Expectations(const Experiment& experiment, std::vector<nlohmann::ordered_json> rows);

  /// From the finished rows of the trial on the same image; without any, its share of the experiment's
  /// minutes by the elements aimed at.
  Expectation of(const Trial& trial) const;

 private:
  std::optional<double> seconds_per_weight_;  // from the experiment's minutes
  std::vector<nlohmann::ordered_json> rows_;
};

}  // namespace podm::bench
