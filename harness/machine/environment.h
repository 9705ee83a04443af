// The state of the machine and the build, recorded beside each measurement. A value that is not available
// reads "unavailable: why".
#pragma once

#include "machine/machine.h"
#include "process/programs.h"
#include "rows/row.h"

namespace podm::bench {

/// Returns the machine and the values that do not change during a run: sources, build, libraries, limits. The
/// hash of the topology is left empty.
EnvironmentRecord environment_of_run(const MachineRecord& machine);

/// Sets the values that may change between trials: load, available memory, governor, huge pages and NUMA
/// balancing.
void renew(EnvironmentRecord& environment);

/// Returns hash and --version of mesher and verifier. Throws InputError that names a program that cannot be
/// read.
ProgramRecords describe_programs(const Programs& programs);

}  // namespace podm::bench
