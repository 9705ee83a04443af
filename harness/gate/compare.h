// Two files of records set side by side, e.g. of a program before and after a change.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "rows/row.h"

namespace podm::bench {

/// A mesher's record alone as a row of status ok, of a trial without a name on the image that it read.
Row row_of(const MeshRecord& record);

/// The rows of a file of JSON lines, which are rows or mesher's records. Throws InputError "file:line:
/// fault", also when there are none.
std::vector<Row> read_record_file(const std::string& path);

struct Comparison {
  std::string text;       ///< differing verdicts and meshes, then a table of ratios
  bool is_worse = false;  ///< some verdict is, or some value with evidence
};

/// Matches rows of equal trial, input, algorithm, options, seed and threads; several that match are repeated
/// measurements. A value is worse when the 95 % interval of B's median over A's lies beyond 2 % on its bad
/// side; it has an interval when both have kFewestRepeats rows or one thread decides it. Throws InputError
/// when no row of `a` matches one of `b`, and naming both machines when two of the rows that match were
/// measured on different ones. Records of the mesher alone name no machine: the caller answers for them.
Comparison compare(const std::vector<Row>& a, const std::vector<Row>& b);

inline constexpr int kFewestRepeats = 5;  ///< fewer show too little of the spread

}  // namespace podm::bench
