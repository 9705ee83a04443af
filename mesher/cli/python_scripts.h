// The parts of the program that are Python: pictures and pages. Each is a script that is started as a process
// and told what to do in JSON, so that the program links no VTK.
#pragma once

#include <string>
#include <vector>

namespace podm::cli {

/// The command that runs a script of share/podm/, found from where this program lies: of the build tree or of
/// an installation. Neither the user's own modules nor PYTHONPATH are seen. Throws InputError, which begins
/// with `asked_by`, where script or interpreter is missing.
std::vector<std::string> script_command(const std::string& script, const std::string& asked_by);

}  // namespace podm::cli
