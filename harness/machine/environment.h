// The machine's state and the build: what a measurement needs told beside it. What cannot be known reads
// "unavailable: why".
#pragma once

#include <string>

#include "machine/machine.h"
#include "process/programs.h"
#include "rows/row.h"

namespace podm::bench {

/// The machine, and what else stays during a run: sources, build, libraries, limits. The hash of the topology
/// is left empty.
EnvironmentRecord environment_of_run(const MachineRecord& machine);

/// Sets what may change between trials: load, memory available, governor, huge pages and NUMA balancing.
void renew(EnvironmentRecord& environment);

/// Hash and --version of mesher and verifier. Throws InputError naming a program that cannot be read.
ProgramRecords describe_programs(const Programs& programs);

}  // namespace podm::bench
