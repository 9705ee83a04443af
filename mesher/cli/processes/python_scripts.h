// The parts of the program that are Python: pictures and pages. Each is a script that is started as a process
// and told what to do in JSON, so that the program links no VTK.
#pragma once

#include <string>

#include "cli/processes/signal_thread.h"

namespace podm::cli {

struct ScriptResult {
  std::string output;  ///< what it wrote to standard output
  int exit_code = 0;   ///< 2: bad input, which it has named on standard error
};

/// Runs a script of share/podm/, found from where this program lies: of the build tree or of an installation.
/// Neither the user's own modules nor PYTHONPATH are seen. Throws InputError, which begins with `asked_by`,
/// where script or interpreter is missing.
ScriptResult run_script(const std::string& script, const std::string& argument, const std::string& asked_by,
                        const SignalThread& signals);

}  // namespace podm::cli
