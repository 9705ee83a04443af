// The numbers of a row that claims of experiments speak of, by name. experiments/README.md lists them.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "rows/row.h"

namespace podm::bench {

/// A number, or why a row has none.
struct Value {
  std::optional<double> number;
  std::string absence;
};

enum class Better { kLess, kMore };

/// What a measure's numbers are of; it decides which rows have one and what may stand together.
enum class Meaning {
  kClock,         ///< time of the clock: of measured rows alone
  kVirtualClock,  ///< virtual time: of simulated rows alone
  kCost,          ///< losses, memory, misses of caches: measured and simulated ones never in one claim
  kCount,         ///< work that was done, likewise; one thread does the same in each run
  kFaults,        ///< faults of a mesh, or what it costs a solver, whoever made it, and whatever it misses
  kAnswer,        ///< 1 or 0, of such a mesh
  kOutcome,       ///< 1 or 0, of a trial, also one without a mesh
};

struct Measure {
  const char* name;
  const char* unit;
  Better better;
  Meaning meaning;
  Value (*read)(const Row& row);
  /// Where this is there, the measure is the growth of read() over that of `per` from the smallest to the
  /// largest target_elements: what is the same for both, reading the image, falls out.
  Value (*per)(const Row& row) = nullptr;
};

std::span<const Measure> measures();
/// Returns null where there is no measure of this name.
const Measure* find_measure(const std::string& name);
/// Whether a claim of this basis may ask for the measure.
bool fits(const Measure& measure, Basis basis);
/// Whether its numbers vary from repeat to repeat and are told by their median; others hold of each row.
bool varies(const Measure& measure);
/// Whether another run of the row's trial may come to another number: a median of such rows needs an
/// interval. Virtual time and simulated work are the same in each run, and so is what one thread does.
bool varies_between_runs(const Measure& measure, const Row& row);
bool is_yes_or_no(const Measure& measure);

}  // namespace podm::bench
