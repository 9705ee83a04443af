// What a person reads at the end of an experiment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

/// Columns of the same number on every line, the first the heading, aligned; each line ended. The last and
/// the first `num_text_columns` are aligned to the left.
std::string align(const std::vector<std::vector<std::string>>& lines, std::size_t num_text_columns);

/// A line for each trial that has rows besides those of warm-ups, and below what the rates leave out. Seconds
/// are those of meshing_seconds(); numbers are medians over the repeats that hold all they promise, and "-"
/// without any.
std::string format_table(const std::vector<std::vector<Row>>& rows_of_trials);

/// "L1 cache 4.1 cycles, L2 cache 14 cycles, ...": medians over records that measure the same machine.
std::string memory_levels(const std::vector<const MemoryLevelsRecord*>& records);

/// "1 234 567".
std::string thousands(std::uint64_t number);

}  // namespace podm::bench
