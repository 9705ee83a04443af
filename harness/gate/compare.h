// Compares two files of records, e.g. of a program before and after a change.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "rows/row.h"

namespace podm::bench {

/// Makes a row of a mesher's record: status ok, a trial without a name, on the image that the mesher read.
Row row_of(const MeshRecord& record);

/// Returns the rows of a file of JSON lines, which are rows or mesher's records. Throws InputError
/// "file:line: fault", also when there are none.
std::vector<Row> read_record_file(const std::string& path);

struct Comparison {
  std::string text;       ///< differing verdicts and meshes, then a table of ratios
  bool is_worse = false;  ///< a verdict, or a value that has an interval, is worse
};

/// Compares rows of equal trial, input, algorithm, options, seed and threads. Several matching rows are
/// repeated measurements. A value is worse when the interval of B's median over A's lies beyond 2 % on the
/// value's bad side, and "same" when the interval lies within 2 %. The interval decides if its coverage is at
/// least kConfidence (rows/order_statistics.h), which takes seven rows on both sides, or if the value is the
/// work of one thread, which each run repeats. Throws InputError when no row of `a` matches a row of `b`.
/// Throws InputError that names both machines when two of the matching rows were measured on different
/// machines. Records of the mesher alone name no machine: the caller must ensure that they are of one
/// machine.
Comparison compare(const std::vector<Row>& a, const std::vector<Row>& b);

}  // namespace podm::bench
