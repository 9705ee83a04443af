// Rows of equal options, and the numbers that a measure reads from them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rows/measure.h"
#include "rows/order_statistics.h"
#include "rows/row_filter.h"
#include "rows/statistics.h"

namespace podm::bench {

/// What the reason begins with where rows of a trial have no number as the trial failed.
inline constexpr const char* kRowsFailed = "rows failed";

/// Rows whose options agree but for some keys, in the order of their first rows.
struct RowGroup {
  Json options;  ///< those that they agree in
  RowPointers rows;
};
/// The keys that `is_free` says yes to may differ within a group.
std::vector<RowGroup> group_rows(const RowPointers& rows,
                                 const std::function<bool(const std::string& key)>& is_free);

/// What a group is called among others: the options that not all of them share; "" for one alone.
std::vector<std::string> labels_of(const std::vector<RowGroup>& groups);

/// Repeats of one measurement.
struct Samples {
  std::vector<double> numbers;
  std::vector<int> rounds;  ///< the round of each number
  std::string absence;      ///< why there are no numbers; empty: there are
  std::size_t num_rows = 0;
  bool varies = false;  ///< another run may come to another number
  double busy = 0;      ///< the most processors that other work kept busy during a disturbed row; 0: none was

  double middle() const { return median(numbers); }
};

/// Rows of rounds during which the machine's speed moved are left out where their numbers vary.
Samples sample(const RowPointers& rows, const Measure& measure);

/// What repeats tell of one number.
struct Estimate {
  double value = 0;                  ///< the median
  std::optional<Interval> interval;  ///< nothing where the number is the same in each run
  std::vector<double> samples;       ///< those behind the interval; none for series that share no rounds
  std::size_t num_rounds = 0;        ///< of the series that has fewer
  double busy = 0;                   ///< as in Samples
};

Estimate estimate_of(const Samples& samples);
/// Where both series ran in the same rounds, the median of the ratios within rounds; else the ratio of the
/// medians.
Estimate ratio_of(const Samples& above, const Samples& below);

}  // namespace podm::bench
