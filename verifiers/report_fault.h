// Faults end podm-verify and podm-verify-mpi alike: a message on stderr and an exit code.
#pragma once

#include <string>

namespace podm::verify {

/// Makes a write fail at a limit of file size or at a closed pipe, so that it is reported and cleaned up.
void let_writes_fail();

/// Prints the exception that is being handled after `prefix`, the program's name and what else the reader
/// needs. Returns the exit code.
int report_fault(const std::string& prefix);

}  // namespace podm::verify
