// The machine of a row: its identity, and whether it was quiet and steady during the trial.
#pragma once

#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

/// The share of each usable processor that other work may keep busy before a row counts as disturbed.
inline constexpr double kToleratedLoad = 0.1;

/// True if a ratio of clock times may compare the rows: their machines are equal in all members of
/// MachineRecord. Rows without an identity must also have equal hashes of their topology, which contains the
/// processor's model.
bool same_machine(const Row& a, const Row& b);

/// Returns one line with all data that distinguishes the row's machine from others.
std::string machine_name(const Row& row);

/// Returns "" for a measured row. Simulated rows do not depend on the machine that simulates. Returns the
/// hash of the described machine, or, if none is described, the number of NUMA nodes that the virtual workers
/// are spread over.
std::string model_of(const Row& row);

/// Returns the mean number of processors that other work kept busy during the trial; 0 if it is unknown.
double busy_elsewhere(const Row& row);

/// True if other work kept more than kToleratedLoad of the usable processors busy during the trial. False for
/// simulated rows and if the load is unknown.
bool is_disturbed(const Row& row);

/// True if the machine's speed moved during the row's round (experiments/round_probes.h). False if this is
/// unknown.
bool probe_moved(const Row& row);

/// Counts of measured rows by the state of their machine.
struct MachineState {
  int measured = 0;           ///< including warm-ups
  int disturbed = 0;          ///< of the measured rows
  int moved = 0;              ///< of the measured rows
  double busy_elsewhere = 0;  ///< mean over the disturbed rows
  int processors = 0;         ///< usable processors of the last disturbed row

  /// Returns sentences for the user; none if the machine was quiet and steady.
  std::vector<std::string> remarks() const;
};
MachineState machine_state(const std::vector<Row>& rows);

/// "Rows of other machines than the newest row's are left out: 3 of AMD EPYC (...)."; "" for no rows.
std::string describe_left_out(const std::vector<Row>& rows_of_other_machines);

}  // namespace podm::bench
