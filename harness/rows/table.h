// The table that the user reads at the end of an experiment.
#pragma once

#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

/// Aligns columns of lines that all have the same number of columns. The first line is the heading; each line
/// is ended. The last column and the first `num_text_columns` are aligned to the left.
std::string align(const std::vector<std::vector<std::string>>& lines, std::size_t num_text_columns);

/// Returns one line per trial that has rows besides warm-ups, and below them what the rates leave out.
/// Seconds are those of meshing_seconds(). Numbers are medians over the repeats of status ok, and "-" if
/// there are none.
std::string format_table(const std::vector<std::vector<Row>>& rows_of_trials);

/// "L1 cache 4.1 cycles, L2 cache 14 cycles, ...": medians over records of the same machine.
std::string memory_levels(const std::vector<const MemoryLevelsRecord*>& records);

/// "1 234 567".
std::string thousands(std::uint64_t number);

}  // namespace podm::bench
