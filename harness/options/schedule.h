// The order in which the trials of an experiment run.
#pragma once

#include <cstdint>
#include <vector>

#include "options/trial_settings.h"

namespace podm::bench {

/// One mesh to make.
struct Turn {
  std::size_t trial = 0;  ///< its index
  int repeat = 1;         ///< its number, from 1, counted among warm-ups or among measured repeats
  bool is_warmup = false;

  bool operator==(const Turn&) const = default;
};

/// Rounds, those of warm-ups first. A round holds each trial that has so many repeats once, in an order drawn
/// anew from `seed`: a machine's drift then falls on all trials alike, and none has a favoured predecessor.
std::vector<Turn> schedule(const std::vector<Trial>& trials, std::uint64_t seed);

}  // namespace podm::bench
