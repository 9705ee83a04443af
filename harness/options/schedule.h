// The order in which the trials of an experiment run.
#pragma once

#include <cstdint>
#include <vector>

#include "options/trial_settings.h"

namespace podm::bench {

/// One run of a trial.
struct Turn {
  std::size_t trial = 0;  ///< index of the trial
  int repeat = 1;         ///< number of the round, from 1; warm-ups and measured repeats are counted apart
  bool is_warmup = false;

  bool operator==(const Turn&) const = default;
};

/// Returns the turns in rounds, warm-up rounds first. Round n holds each trial that has at least n repeats
/// (or warm-ups) once, in an order drawn anew from `seed`. A drift of the machine then affects all trials
/// alike, and no trial always follows the same other trial.
std::vector<Turn> schedule(const std::vector<Trial>& trials, std::uint64_t seed);

}  // namespace podm::bench
