// The measures of a row that claims of experiments use, by name. experiments/README.md lists them.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "rows/row.h"

namespace podm::bench {

/// A number, or the reason why a row has none.
struct Value {
  std::optional<double> number;
  std::string absence;
};

enum class Better { kLess, kMore };

/// The kind of a measure's numbers. It decides which rows have a number and which numbers may be combined.
enum class Meaning {
  kClock,         ///< wall time; only measured rows have it
  kVirtualClock,  ///< virtual time; only simulated rows have it
  kCost,          ///< losses, memory, cache misses; one claim never mixes measured and simulated ones
  kCount,         ///< work done, likewise never mixed; equal in each run of one thread
  kFaults,        ///< faults of a mesh, or its cost for a solver, for any mesher and any status with a mesh
  kAnswer,        ///< 1 or 0, for a mesh as with kFaults
  kOutcome,       ///< 1 or 0, for a trial, also without a mesh
};

struct Measure {
  const char* name;
  const char* unit;
  Better better;
  Meaning meaning;
  Value (*read)(const Row& row);
  /// If set, the measure is the growth of read() over the growth of `per` from the smallest to the largest
  /// target_elements. Costs that both sizes share, such as reading the image, cancel.
  Value (*per)(const Row& row) = nullptr;
};

std::span<const Measure> measures();
/// Returns null if there is no measure of this name.
const Measure* find_measure(const std::string& name);
/// True if a claim of this basis may use the measure.
bool fits(const Measure& measure, Basis basis);
/// True if the numbers vary between repeats and are summarised by their median; otherwise each row's number
/// counts.
bool varies(const Measure& measure);
/// True if another run of the row's trial may give another number; a median of such rows needs an interval.
/// Virtual time, simulated work and the work of one thread are the same in each run.
bool varies_between_runs(const Measure& measure, const Row& row);
bool is_yes_or_no(const Measure& measure);

}  // namespace podm::bench
