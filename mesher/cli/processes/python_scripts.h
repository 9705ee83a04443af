// The Python parts of the program: pictures and pages. Each is a script that runs as a process and gets its
// request in JSON, so that the program does not link VTK.
#pragma once

#include <string>

#include "cli/processes/signal_thread.h"

namespace podm::cli {

struct ScriptResult {
  std::string output;  ///< its standard output
  int exit_code = 0;   ///< 2: bad input, which the script has named on standard error
};

/// Runs a script of share/podm/, located relative to this program, in the build tree or in an installation.
/// The script sees neither the user's own modules nor PYTHONPATH. Throws InputError, which begins with
/// `asked_by`, if script or interpreter is missing.
ScriptResult run_script(const std::string& script, const std::string& argument, const std::string& asked_by,
                        const SignalThread& signals);

/// Replaces this program by a script, which gets its process, its signals and its exit code. Returns only by
/// InputError, if it cannot.
[[noreturn]] void become_script(const std::string& script, const std::string& argument,
                                const std::string& asked_by);

}  // namespace podm::cli
