// Makes a row of a trial's result: the mesher's own record, and the harness's observations around it.
#pragma once

#include <optional>
#include <string>

#include "options/schedule.h"
#include "rows/row.h"
#include "trials/trial.h"

namespace podm::bench {

/// The members of a row that do not come from the trial and its result.
struct RowContext {
  std::string experiment;         ///< name of the experiment
  std::string key;                ///< identifies the turn: TrialKeys
  std::uint64_t order_seed = 0;   ///< seed of the schedule
  double harness_s = 0;           ///< time that this program spent since the row before
  ProgramRecords programs;        ///< describe_programs()
  EnvironmentRecord environment;  ///< before the trial
};

/// Rows with these options and counters are simulated if they ran in virtual time, on a described machine or
/// on cachegrind's core; otherwise they are measured.
Basis basis_of(const Json& asked, const Counters& counters);

/// Returns the peak resident bytes per cell without the labels of the image; nothing without a mesh. If there
/// are several processes, the memory is that of the largest process, divided by its even share of the cells.
std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result, int num_processes = 1);

/// Makes the row of a trial that ran, whatever its outcome.
Row make_row(const RowContext& context, const Trial& trial, const Turn& turn, const TrialResult& result);

}  // namespace podm::bench
