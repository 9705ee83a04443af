// Rows of equal options, and the numbers that a measure reads from them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rows/measure.h"
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

  double middle() const { return median(numbers); }
};

Samples sample(const RowPointers& rows, const Measure& measure);

struct SeriesRatio {
  Ratio ratio;
  bool has_interval = false;  ///< both were measured more than once
};
/// The ratio is that of the medians; where both ran in the same rounds, it is the median of the ratios within
/// rounds. Numbers that are not positive have no interval, and a ratio over 0 is infinite, or 1 where both
/// are 0.
SeriesRatio ratio_of(const Samples& above, const Samples& below);

}  // namespace podm::bench
