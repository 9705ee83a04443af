// The machine that a row was measured on: which one it was, and whether it was quiet and steady meanwhile.
#pragma once

#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

/// Other work may keep this share of each usable processor busy before a row counts as disturbed.
inline constexpr double kToleratedLoad = 0.1;

/// Two rows may meet in a ratio of the clock: their machines are equal in all that MachineRecord holds. Rows
/// without an identity are also told apart by the hash of their topology, which has the processor's model.
bool same_machine(const Row& a, const Row& b);

/// One line with all that tells the row's machine from others.
std::string machine_name(const Row& row);

/// "" for a measured row. Simulated rows do not depend on the machine that simulates: the hash of the
/// described machine, or, where none is described, the number of NUMA nodes that the virtual workers are
/// spread over.
std::string model_of(const Row& row);

/// Mean number of processors that other work kept busy during the trial; 0 where it is unknown.
double busy_elsewhere(const Row& row);

/// Other work kept more than kToleratedLoad of the usable processors busy during the trial. False for
/// simulated rows and where the load is unknown.
bool is_disturbed(const Row& row);

/// The machine's speed moved during the row's round (experiments/round_probes.h). False where it is unknown.
bool probe_moved(const Row& row);

/// Counts of measured rows by the state of their machine.
struct MachineState {
  int measured = 0;           ///< with warm-ups
  int disturbed = 0;          ///< of these
  int moved = 0;              ///< of these
  double busy_elsewhere = 0;  ///< mean over the disturbed rows
  int processors = 0;         ///< usable ones, of the last disturbed row

  /// Sentences for people, none where the machine was quiet and steady.
  std::vector<std::string> remarks() const;
};
MachineState machine_state(const std::vector<Row>& rows);

/// "3 rows are left out, which other machines measured: 3 of AMD EPYC (...)"; "" for none.
std::string describe_left_out(const std::vector<Row>& rows_of_other_machines);

}  // namespace podm::bench
