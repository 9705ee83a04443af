// Rows of equal options, and the numbers that a measure reads from them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rows/measure.h"
#include "rows/order_statistics.h"
#include "rows/row_filter.h"

namespace podm::bench {

/// The start of the reason why rows have no number because their trial failed.
inline constexpr const char* kRowsFailed = "rows failed";

/// Rows whose options agree except for some keys, in the order of their first rows.
struct RowGroup {
  Json options;  ///< the options in which they agree
  RowPointers rows;
};
/// The keys for which `is_free` is true may differ within a group.
std::vector<RowGroup> group_rows(const RowPointers& rows,
                                 const std::function<bool(const std::string& key)>& is_free);

/// Returns the label of each group among the others: the options that not all of them share; "" for a single
/// group.
std::vector<std::string> labels_of(const std::vector<RowGroup>& groups);

/// Repeats of one measurement.
struct Samples {
  std::vector<double> numbers;
  std::vector<int> rounds;  ///< the round of each number
  std::string absence;      ///< the reason why there are no numbers; empty: there are
  std::size_t num_rows = 0;
  bool varies = false;  ///< another run may give another number
  double busy = 0;      ///< most processors kept busy by other work in a disturbed row; 0: no such row

  double middle() const { return median(numbers); }
};

/// Leaves out rows of rounds during which the machine's speed moved, if their numbers vary.
Samples sample(const RowPointers& rows, const Measure& measure);

/// The estimate of one number from repeats.
struct Estimate {
  double value = 0;                  ///< the median
  std::optional<Interval> interval;  ///< unset if the number is the same in each run
  std::vector<double> samples;       ///< those behind the interval; none for series that share no rounds
  std::size_t num_rounds = 0;        ///< of the series with fewer rounds
  double busy = 0;                   ///< as in Samples
};

Estimate estimate_of(const Samples& samples);
/// Returns the median of the ratios within rounds if both series ran in the same rounds; otherwise the ratio
/// of the medians.
Estimate ratio_of(const Samples& above, const Samples& below);

}  // namespace podm::bench
