// How what came of a trial becomes a row: the mesher's own record, and around it what the harness saw.
#pragma once

#include <optional>
#include <string>

#include "options/schedule.h"
#include "rows/row.h"
#include "trials/trial.h"

namespace podm::bench {

/// What a row tells beside the trial and its result.
struct RowContext {
  std::string experiment;         ///< its name
  std::string key;                ///< names the turn: TrialKeys
  std::uint64_t order_seed = 0;   ///< draws the schedule
  double harness_s = 0;           ///< spent by this program since the row before
  ProgramRecords programs;        ///< describe_programs()
  EnvironmentRecord environment;  ///< before the trial
};

/// Rows with these options and counters are simulated in virtual time, on a described machine and on
/// cachegrind's core, else measured.
Basis basis_of(const Json& asked, const Counters& counters);

/// Peak resident bytes a cell beyond the labels of the image; nothing without a mesh. Of several processes
/// the memory is that of the largest, which has its even share of the cells.
std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result, int num_processes = 1);

/// The row of a trial that ran, whatever came of it.
Row make_row(const RowContext& context, const Trial& trial, const Turn& turn, const TrialResult& result);

}  // namespace podm::bench
