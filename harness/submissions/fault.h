// A reason why a submission is not valid.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

struct Fault {
  std::string rule;  ///< the rule that is broken, in a word or two: "clock"
  std::string text;  ///< the place and what is wrong there
};
using Faults = std::vector<Fault>;

/// "quality: 1M,threads=2, repeat 3", the name of a row in texts.
inline std::string name_of(const Row& row) {
  return fmt::format("{}: {}, repeat {}{}", row.experiment, row.trial, row.repeat,
                     row.warmup ? " (warm-up)" : "");
}

}  // namespace podm::bench
