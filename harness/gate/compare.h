// Two files of records set side by side, e.g. of a program before and after a change.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/experiment.h"

namespace podm::bench {

/// The rows of a file of JSON lines. Throws InputError "file:line: fault", also when there are none.
std::vector<nlohmann::ordered_json> read_record_file(const std::string& path);

struct Comparison {
  std::string text;       ///< differing verdicts and meshes, then a table of ratios
  bool is_worse = false;  ///< some verdict is, or some value with evidence
};

/// Matches rows of equal trial, input, algorithm, options, seed and threads; several that match are repeated
/// measurements. A value is worse when the 95 % interval of B's median over A's lies beyond 2 % on its bad
/// side; it has an interval when both have kFewestRepeats rows or one thread decides it. Throws InputError
/// when no row of `a` matches one of `b`.
Comparison compare(const std::vector<nlohmann::ordered_json>& a,
                   const std::vector<nlohmann::ordered_json>& b);

inline constexpr int kFewestRepeats = 5;  ///< fewer show too little of the spread

}  // namespace podm::bench
